// Typed access to the tables of a TOML file; whatever is wrong becomes a fault with its line.
#pragma once

#include <toml++/toml.h>

#include <filesystem>
#include <optional>
#include <span>
#include <string>
#include <string_view>

#include "lab_data/faults.hpp"

namespace loam::lab_data {

/// The file's root table. Reports faults of read_text() and of the syntax and gives nothing then. At most 256
/// KiB.
std::optional<toml::table> parse_toml(const std::filesystem::path& path, Faults& faults);

/// The first dotted key of more than 16 parts (a.b.c...), if there is one. The parser makes nested tables of
/// it without a limit, and destroying them takes stack for each.
std::optional<Fault> fault_of_deep_key(std::string_view text, const std::string& file);

/// A table of a file. The reading functions report a value of another type, and give what absence would give.
class TomlTable {
  public:
    /// `header_line`: line of the table's header for what is missing in it; 0: none.
    TomlTable(const toml::table& table, std::string file, int header_line, Faults& faults)
        : table_(table), file_(std::move(file)), header_line_(header_line), faults_(faults) {}

    bool has(std::string_view key) const { return table_.contains(key); }
    const toml::node* node(std::string_view key) const { return table_.get(key); }
    const toml::table& table() const { return table_; }

    /// The place of `key`'s value if it is there, with the value; else that of the table.
    Fault at(std::string_view key) const;
    void missing(std::string_view key, const std::string& remedy) const;

    /// The text without white space at its ends; empty if absent.
    std::string text(std::string_view key) const;
    /// Likewise, but absence and an empty text are faults.
    std::string needed_text(std::string_view key, const std::string& remedy) const;
    std::optional<double> number(std::string_view key) const;
    std::optional<bool> boolean(std::string_view key) const;
    /// `path`: how a header names it, where it is no table of the root.
    const toml::table* subtable(std::string_view key, std::string_view path = {}) const;

    /// Reports every key that is not one of `valid`.
    void allow_only(std::span<const std::string_view> valid) const;

  private:
    void wrong_type(std::string_view key, const std::string& type, const std::string& remedy) const;

    const toml::table& table_;
    std::string file_;
    int header_line_;
    Faults& faults_;
};

/// The line where a node stands in its file.
int line_of(const toml::node& node);

/// A node's value as text for messages.
std::string value_text(const toml::node& node);

/// A finite number, written as integer or float; nothing for other types, inf and nan.
std::optional<double> number_of(const toml::node& node);

}  // namespace loam::lab_data
