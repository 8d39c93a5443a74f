#include <fmt/format.h>
#include <toml++/toml.h>

#include <algorithm>
#include <array>
#include <sstream>

#include "experiments/settings/conversion.hpp"
#include "experiments/settings/reading.hpp"
#include "lab_data/nearest_name.hpp"
#include "lab_data/toml_table.hpp"

namespace loam::experiments {
namespace {

using lab_data::UserError;

std::string text_of(const toml::node& node) {
    std::ostringstream text;
    node.visit([&](const auto& value) { text << value; });
    return text.str();
}

Origin origin_of(const std::string& file, const toml::source_region& where, std::string name) {
    return {file, static_cast<int>(where.begin.line), static_cast<int>(where.begin.column), std::move(name)};
}

/// Assigns a TOML value to the value that a slot points to, by its type.
struct FromToml {
    const Field& field;
    const toml::node& node;
    const Origin& origin;
    const std::filesystem::path& folder;

    UserError wrong_type(const char* constraint) const {
        return fault_at(origin, text_of(node), constraint, "");
    }

    void operator()(bool* slot) const {
        if (!node.is_boolean()) throw wrong_type("must be true or false");
        *slot = **node.as_boolean();
    }
    std::int64_t integer() const {
        if (!node.is_integer()) throw wrong_type("must be an integer");
        return **node.as_integer();
    }
    void operator()(int* slot) const { *slot = fitted<int>(integer(), field, origin); }
    void operator()(std::uint64_t* slot) const { *slot = fitted<std::uint64_t>(integer(), field, origin); }
    void operator()(double* slot) const {
        const auto value = node.value<double>();
        if (!value || !node.is_number()) throw wrong_type("must be a number");
        *slot = *value;
    }
    void operator()(std::optional<double>* slot) const { (*this)(&slot->emplace()); }
    void operator()(std::string* slot) const {
        if (!node.is_string()) throw wrong_type("must be text in quotes");
        *slot = **node.as_string();
    }
    void operator()(std::filesystem::path* slot) const {
        std::string text;
        (*this)(&text);
        *slot = based_on(folder, text);
    }
    void operator()(std::vector<std::string>* slot) const {
        slot->clear();
        if (node.is_string()) return add_item(*slot, node);
        if (!node.is_array() || (!node.as_array()->empty() && !node.is_homogeneous(toml::node_type::string)))
            throw wrong_type("must be a list of texts in quotes");
        for (const toml::node& item : *node.as_array()) add_item(*slot, item);
    }
    void add_item(std::vector<std::string>& items, const toml::node& item) const {
        items.push_back(**item.as_string());
        if (items.back().empty())
            throw fault_at(origin, text_of(node), "has an empty item", "fill it in, or leave it out");
    }
};

class TomlReader {
  public:
    TomlReader(Draft& draft, const std::filesystem::path& file)
        : draft_(draft), file_(file.string()), folder_(std::filesystem::absolute(file).parent_path()) {}

    void read(const toml::table& root) {
        for (const auto& [key, node] : root) {
            const std::string_view name = key.str();
            const toml::table* const table = node.as_table();
            if (const Field* field = find_field("", name))
                assign(*field, key, node);
            else if (!is_table_name(name))
                throw unknown(key, top_level_names());
            else if (!table)
                throw fault_at(at(key, std::string(name)), text_of(node), "must be a table",
                               "write [" + std::string(name) + "]");
            else if (name == "set")
                read_set(*table);
            else if (name == "priors")
                read_priors(*table);
            else
                read_section(name, *table);
        }
        refuse_priors_of_fixed(root);
    }

  private:
    Origin at(const toml::key& key, std::string name) const {
        return origin_of(file_, key.source(), std::move(name));
    }

    static bool is_table_name(std::string_view name) {
        const auto names = sections();
        return name == "set" || name == "priors" || std::ranges::find(names, name) != names.end();
    }

    static std::vector<std::string_view> top_level_names() {
        std::vector<std::string_view> names;
        for (const Field& field : fields())
            if (field.section.empty()) names.push_back(field.key);
        for (const std::string_view section : sections()) names.push_back(section);
        names.insert(names.end(), {"set", "priors"});
        return names;
    }

    UserError unknown(const toml::key& key, const std::vector<std::string_view>& valid) const {
        const std::string name(key.str());
        return fault_at(at(key, name), "", "is not a setting", lab_data::suggest_name(name, valid));
    }

    void assign(const Field& field, const toml::key& key, const toml::node& node) {
        const Origin origin = at(key, field.path());
        std::visit(FromToml{field, node, origin, folder_}, field.slot(draft_.settings));
        draft_.origins[field.path()] = origin;
    }

    void read_section(std::string_view section, const toml::table& table) {
        for (const auto& [key, node] : table) {
            const Field* const field = find_field(section, key.str());
            if (!field) {
                std::vector<std::string_view> valid;
                for (const Field& other : fields())
                    if (other.section == section) valid.push_back(other.key);
                throw unknown(key, valid);
            }
            assign(*field, key, node);
        }
    }

    /// A prior that the same file makes void is a mistake; an option may make it so.
    void refuse_priors_of_fixed(const toml::table& root) const {
        const toml::table* const fixed = root["set"].as_table();
        const toml::table* const priors = root["priors"].as_table();
        if (!fixed || !priors) return;
        for (const auto& [key, node] : *priors)
            if (fixed->contains(key.str()))
                throw fault_at(at(key, fmt::format("priors.{}", key.str())), "",
                               fmt::format("contradicts set.{}, which holds the parameter fixed", key.str()),
                               "leave one of the two out");
    }

    double number(const toml::node& node, const Origin& origin) const {
        const auto value = node.value<double>();
        if (!value || !node.is_number()) throw fault_at(origin, text_of(node), "must be a number", "");
        return *value;
    }

    void read_set(const toml::table& table) {
        for (const auto& [key, node] : table) {
            const std::string path = "set." + std::string(key.str());
            const Origin origin = at(key, path);
            draft_.settings.set[std::string(key.str())] = number(node, origin);
            draft_.origins[path] = origin;
        }
    }

    void read_priors(const toml::table& table) {
        for (const auto& [key, node] : table) {
            const std::string parameter(key.str());
            const std::string path = "priors." + parameter;
            draft_.origins[path] = at(key, path);
            if (!node.is_table())
                throw fault_at(at(key, path), text_of(node), "must be a table", "write [" + path + "]");
            for (const auto& [member, value] : *node.as_table())
                read_prior_member(draft_.priors[parameter], path, member, value);
        }
    }

    void read_prior_member(PriorText& prior, const std::string& path, const toml::key& key,
                           const toml::node& node) {
        const std::string name(key.str());
        const Origin origin = at(key, path + "." + name);
        constexpr std::array<std::string_view, 5> members{"kind", "mean", "sd", "lower", "upper"};
        if (std::ranges::find(members, name) == members.end())
            throw fault_at(origin, "", "is not a part of a prior", lab_data::suggest_name(name, members));
        draft_.origins[origin.name] = origin;
        if (name != "kind") {
            prior.numbers[name] = number(node, origin);
            return;
        }
        if (!node.is_string()) throw fault_at(origin, text_of(node), "must be text in quotes", "");
        prior.kind = **node.as_string();
    }

    Draft& draft_;
    std::string file_;
    std::filesystem::path folder_;  // of the file: paths in it are relative to this
};

}  // namespace

void read_toml(Draft& draft, std::string_view text, const std::filesystem::path& file) {
    if (auto fault = lab_data::fault_of_deep_key(text, file.string())) throw UserError(std::move(*fault));
    try {
        TomlReader(draft, file).read(toml::parse(text, file.string()));
    } catch (const toml::parse_error& error) {
        const auto where = origin_of(file.string(), error.source(), "");
        throw fault_at(where, "", "is not TOML: " + std::string(error.description()), "correct the line");
    }
}

}  // namespace loam::experiments
