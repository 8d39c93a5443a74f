// The report as text: what is embedded comes back unchanged and cannot break out of its element. How it looks
// and whether its charts draw is tested in a browser (tests/workflow/report).
#include <gtest/gtest.h>

#include <fstream>
#include <limits>
#include <regex>
#include <sstream>

#include "experiments/report/assets.hpp"
#include "experiments/report/report.hpp"

namespace {

using loam::experiments::report_html;
using nlohmann::json;

const std::string opening = R"(<script type="application/json" id="document">)";

json embedded_document(const std::string& html) {
    const std::size_t begin = html.find(opening) + opening.size();
    return json::parse(html.substr(begin, html.find("</script>", begin) - begin));
}

std::size_t occurrences(const std::string& text, const std::string& part) {
    std::size_t n = 0;
    for (std::size_t at = text.find(part); at != std::string::npos; at = text.find(part, at + 1)) ++n;
    return n;
}

std::string file_text(const std::string& path) {
    std::ifstream file(std::string(LOAM_SOURCE_DIR) + "/" + path);
    std::ostringstream text;
    text << file.rdbuf();
    return text.str();
}

TEST(Report, GivesTheDocumentBackWhateverItsTexts) {
    const json document = {
        {"verb", "calibrate"},
        {"name", "</script><!--<script>alert(1)</script> \xE2\x80\xA8\xE2\x80\xA9 {{script}} \\u003c \"'&"},
        {"tests", json::array({{{"x", {1.0, 0.1 + 0.2, 1e-300}}}})}};
    EXPECT_EQ(embedded_document(report_html(document)), document);
}

TEST(Report, TextCannotEndTheElementThatHoldsIt) {
    const std::string plain = report_html({{"verb", "simulate"}, {"name", "plain"}});
    const std::string hostile =
        report_html({{"verb", "simulate"}, {"name", "</script></SCRIPT ><!--<script>{{style}}"}});
    for (const char* part : {"</script", "<script", "<!--", "{{", "<style"}) {
        const bool in_document =
            std::string(part) == "{{";  // harmless there: what is put in is not searched again
        EXPECT_EQ(occurrences(hostile, part), occurrences(plain, part) + (in_document ? 1 : 0)) << part;
    }
    EXPECT_EQ(occurrences(plain, "{{"), 0u) << "a placeholder was left in the page";
}

TEST(Report, NumbersThatAreNotFiniteBecomeNull) {
    const double infinity = std::numeric_limits<double>::infinity();
    const json document = {{"verb", "simulate"}, {"name", "gaps"}, {"x", {1.0, std::nan(""), infinity}}};
    EXPECT_EQ(embedded_document(report_html(document))["x"], json({1.0, nullptr, nullptr}));
}

TEST(Report, BytesThatAreNotUtf8AreReplaced) {
    const std::string html = report_html({{"verb", "simulate"}, {"name", "caf\xE9"}});
    EXPECT_EQ(embedded_document(html)["name"], "caf\xEF\xBF\xBD");
}

TEST(Report, SameDocumentSameBytes) {
    const json document = {{"verb", "simulate"}, {"name", "twice"}};
    EXPECT_EQ(report_html(document), report_html(document));
}

TEST(Report, RefusesWhatIsNoDocument) {
    EXPECT_THROW(report_html(json::array()), std::invalid_argument);
    EXPECT_THROW(report_html({{"name", "no verb"}}), std::invalid_argument);
    EXPECT_THROW(report_html({{"verb", "simulate"}, {"name", 3}}), std::invalid_argument);
}

TEST(Report, CarriesItsScriptsAsTheyStandInTheTree) {
    std::size_t own = 0;
    for (const auto& asset : loam::experiments::report::embedded_assets()) {
        if (asset.name.starts_with("vega-")) continue;
        EXPECT_EQ(asset.text, file_text("experiments/report/" + std::string(asset.name))) << asset.name;
        ++own;
    }
    EXPECT_GT(own, 15u);
}

TEST(Report, EveryModuleThatAScriptRequiresIsThere) {
    const auto assets = loam::experiments::report::embedded_assets();
    const std::regex require(R"(require\("([^"]+)\"\))");
    for (const auto& asset : assets) {
        const std::string text(asset.text);
        for (std::sregex_iterator it(text.begin(), text.end(), require), end; it != end; ++it) {
            const std::string wanted = (*it)[1];
            EXPECT_TRUE(
                std::any_of(assets.begin(), assets.end(), [&](const auto& a) { return a.name == wanted; }))
                << asset.name << " requires " << wanted;
        }
    }
}

}  // namespace
