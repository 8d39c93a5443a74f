#include "experiments/report/report.hpp"

#include <stdexcept>
#include <string_view>

#include "experiments/report/assets.hpp"

namespace loam::experiments {
namespace {

std::string_view asset(std::string_view name) {
    for (const report::Asset& candidate : report::embedded_assets()) {
        if (candidate.name == name) return candidate.text;
    }
    throw std::logic_error("no embedded asset named " + std::string(name));
}

bool is_module(std::string_view name) {
    return name != "template.html" && name != "style.css" && name != "page/loader.js";
}

// All scripts as one text: the loader, each file as a module of its own scope, the start.
std::string script() {
    std::string text(asset("page/loader.js"));
    for (const report::Asset& part : report::embedded_assets()) {
        if (!is_module(part.name)) continue;
        text += "\nloam.define(\"";
        text += part.name;
        text += "\", function (exports, require, module) {\n";
        text += part.text;
        text += "\n});";
    }
    return text + "\nloam.require(\"page/main.js\").start();\n";
}

// JSON that may stand inside a <script> element: no text in it can end the element or open a comment.
std::string embedded_json(const nlohmann::json& document) {
    using nlohmann::json;
    const std::string plain = document.dump(-1, ' ', false, json::error_handler_t::replace);
    std::string safe;
    safe.reserve(plain.size() + plain.size() / 16);
    for (std::size_t i = 0; i < plain.size(); ++i) {
        const std::string_view rest = std::string_view(plain).substr(i, 3);
        if (plain[i] == '<') {
            safe += "\\u003c";
        } else if (rest == "\xE2\x80\xA8" ||
                   rest == "\xE2\x80\xA9") {  // line ends in JavaScript, not in JSON
            safe += rest[2] == '\xA8' ? "\\u2028" : "\\u2029";
            i += 2;
        } else {
            safe += plain[i];
        }
    }
    return safe;
}

std::string placeholder(std::string_view name, const nlohmann::json& document) {
    if (name == "style") return std::string(asset("style.css"));
    if (name == "script") return script();
    if (name == "document") return embedded_json(document);
    throw std::logic_error("template.html has an unknown placeholder " + std::string(name));
}

}  // namespace

std::string report_html(const nlohmann::json& document) {
    if (!document.is_object()) throw std::invalid_argument("report: the document must be a JSON object");
    for (const char* key : {"verb", "name"}) {
        if (!document.contains(key) || !document[key].is_string()) {
            throw std::invalid_argument(std::string("report: the document needs the text member ") + key);
        }
    }
    const std::string_view page = asset("template.html");
    std::string html;
    std::size_t at = 0;
    // One pass over the template: what is put in is never searched for placeholders.
    for (std::size_t open; (open = page.find("{{", at)) != std::string_view::npos;) {
        const std::size_t close = page.find("}}", open);
        html += page.substr(at, open - at);
        html += placeholder(page.substr(open + 2, close - open - 2), document);
        at = close + 2;
    }
    html += page.substr(at);
    return html;
}

}  // namespace loam::experiments
