#include "experiments/settings/writing.hpp"

#include <fmt/format.h>

#include "experiments/settings/fields.hpp"
#include "experiments/settings/parameters.hpp"

namespace loam::experiments {
namespace {

/// A TOML basic string.
std::string toml_string(std::string_view text) {
    std::string result = "\"";
    for (const char c : text) {
        if (c == '"' || c == '\\')
            result += fmt::format("\\{}", c);
        else if (static_cast<unsigned char>(c) < 0x20 || c == 0x7f)
            result += fmt::format("\\u{:04x}", static_cast<unsigned>(c));
        else
            result += c;
    }
    return result + '"';
}

/// The shortest text that reads back as the same number.
std::string number(double value) {
    return fmt::format("{}", value);
}

/// The value that a slot points to in TOML; empty for an optional without a value.
struct ToText {
    std::string operator()(const bool* slot) const { return *slot ? "true" : "false"; }
    std::string operator()(const int* slot) const { return fmt::format("{}", *slot); }
    std::string operator()(const std::uint64_t* slot) const { return fmt::format("{}", *slot); }
    std::string operator()(const double* slot) const { return number(*slot); }
    std::string operator()(const std::optional<double>* slot) const { return *slot ? number(**slot) : ""; }
    std::string operator()(const std::string* slot) const { return toml_string(*slot); }
    std::string operator()(const std::filesystem::path* slot) const { return toml_string(slot->string()); }
    std::string operator()(const std::vector<std::string>* slot) const {
        std::string text;
        for (const std::string& item : *slot) text += (text.empty() ? "" : ", ") + toml_string(item);
        return "[" + text + "]";
    }
};

std::string text_of(const Field& field, const Settings& settings) {
    Settings copy = settings;  // slots point into settings that can be changed
    return std::visit([](const auto* slot) { return ToText{}(slot); }, field.slot(copy));
}

std::string prior_text(const Prior& prior) {
    std::string text = fmt::format("kind = \"{}\"\n", to_string(prior.kind));
    if (has_mean(prior.kind))
        text += fmt::format("mean = {}\nsd = {}\n", number(prior.mean), number(prior.sd));
    return text + fmt::format("lower = {}\nupper = {}\n", number(prior.lower), number(prior.upper));
}

std::string section_text(std::string_view section, const Settings& settings) {
    std::string text = section.empty() ? "" : fmt::format("\n[{}]\n", section);
    for (const Field& field : fields()) {
        if (field.section != section) continue;
        const std::string value = text_of(field, settings);
        if (value.empty())
            text += fmt::format("# {}: {}\n", field.key, field.meaning);
        else
            text += fmt::format("{} = {}  # {}\n", field.key, value, field.meaning);
    }
    return text;
}

std::string parameters_text(const Settings& settings) {
    std::string fixed = "\n[set]  # parameters held fixed, SI\n";
    std::string priors;
    for (const engine::ParameterInfo& parameter : model_parameters(settings)) {
        const std::string name(parameter.name);
        if (const auto found = settings.set.find(name); found != settings.set.end())
            fixed += fmt::format("{} = {}  # {}, {}\n", name, number(found->second), parameter.unit,
                                 parameter.meaning);
        if (const auto found = settings.priors.find(name); found != settings.priors.end())
            priors += fmt::format("\n[priors.{}]  # {}, {}{}\n{}", name, parameter.unit, parameter.meaning,
                                  found->second.kind == engine::PriorKind::lognormal
                                      ? "; mean and sd of log10 of the value"
                                      : "",
                                  prior_text(found->second));
    }
    return fixed + priors;
}

/// The first name whose entries differ.
template <class Map>
std::string first_difference_of(const Map& a, const Map& b) {
    for (const auto& [name, value] : a)
        if (const auto found = b.find(name); found == b.end() || found->second != value) return name;
    for (const auto& [name, value] : b)
        if (!a.contains(name)) return name;
    return "";
}

}  // namespace

std::string to_toml(const Settings& settings) {
    std::string text(first_words);
    text += " Relative paths are relative to this file's folder.\n";
    text += section_text("", settings) + parameters_text(settings);
    for (const std::string_view section : sections()) text += section_text(section, settings);
    return text;
}

std::string first_difference(const Settings& stored, const Settings& now) {
    for (const Field& field : fields())
        if (field.resuming == Resuming::must_agree && text_of(field, stored) != text_of(field, now))
            return field.path();
    if (const std::string name = first_difference_of(stored.set, now.set); !name.empty())
        return "set." + name;
    if (const std::string name = first_difference_of(stored.priors, now.priors); !name.empty())
        return "priors." + name;
    return "";
}

std::string value_text(const Settings& settings, const std::string& path) {
    for (const Field& field : fields())
        if (field.path() == path) return text_of(field, settings);
    const std::string name = path.substr(path.find('.') + 1);
    if (path.starts_with("set.") && settings.set.contains(name)) return number(settings.set.at(name));
    if (path.starts_with("priors.") && settings.priors.contains(name)) {
        std::string text = prior_text(settings.priors.at(name));
        for (char& c : text)
            if (c == '\n') c = ' ';
        return text;
    }
    return "";
}

}  // namespace loam::experiments
