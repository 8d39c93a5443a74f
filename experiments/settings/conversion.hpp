// From what is written (text of an option, or a value in TOML that is already a number, a text, ...) to a
// setting.
#pragma once

#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "experiments/settings/fields.hpp"
#include "experiments/settings/reading.hpp"
#include "lab_data/user_error.hpp"

namespace loam::experiments {

/// The error for a setting stated at `origin`.
lab_data::UserError fault_at(const Origin& origin, std::string value, std::string constraint,
                             std::string remedy);

/// The whole text as a finite number with a decimal point. Throws UserError.
double number_of(std::string_view text, const Origin& origin);

/// The whole text as an integer for the field. Throws UserError; one too large for any integer breaks the
/// field's limits.
std::int64_t integer_of(std::string_view text, const Field& field, const Origin& origin);

/// "a,b" as {a, b}; an empty item is a mistake. Throws UserError.
std::vector<std::string> list_of(std::string_view text, const Origin& origin);

/// `value` as the type of a setting's slot; one that does not fit breaks the setting's limits. Throws
/// UserError.
template <class Integer>
Integer fitted(std::int64_t value, const Field& field, const Origin& origin) {
    if (!std::in_range<Integer>(value))
        throw fault_at(origin, std::to_string(value), field.limits.text(), "");
    return static_cast<Integer>(value);
}

/// Sets the field from the text of an option. Throws UserError.
void assign_text(Settings& settings, const Field& field, std::string_view text, const Origin& origin);

/// A path as the user's, relative to `folder`; empty stays empty.
std::filesystem::path based_on(const std::filesystem::path& folder, const std::filesystem::path& path);

}  // namespace loam::experiments
