// The units that end the names of columns and keys (axial_stress_kPa), and how people write them otherwise:
// "Axial stress (kPa)", "axial_strain [%]". Names are compared without their units, since a unit is as short
// as a slip of the pen: one that is taken for another makes a number wrong a hundredfold.
#pragma once

#include <cstddef>
#include <optional>
#include <span>
#include <string>
#include <string_view>

namespace loam::lab_data {

enum class Dimension { stress, length, ratio, label };

/// Factor to SI as a fraction, so that percent and mm convert with one exact rounding.
struct Unit {
    std::string_view suffix;  // empty: none
    Dimension dimension;
    double multiply;
    double divide;

    double to_si(double value) const { return value * multiply / divide; }
};

/// The units that columns may have.
std::span<const Unit> known_units();

/// The unit of that dimension which `text` spells, in any letter case: "kpa", "kN/m2", "%", "mm/mm".
const Unit* spelt_unit(std::string_view text, Dimension dimension);

/// Whether `text` can only be meant as a unit, known here or not.
bool is_unit(std::string_view text);

/// A name with its unit split off; the unit is empty if none is stated.
struct WrittenName {
    std::string quantity, unit;
};
WrittenName split_unit(std::string_view name);

/// Edit distance between two names without unit; nothing if they are too far from each other for one to be
/// meant by the other. Word is compared with word, so that "vertical_displacement" is not
/// "shear_displacement".
std::optional<std::size_t> quantity_distance(std::string_view a, std::string_view b);

/// The name among `valid` that is nearest to `name` without its unit, or else as a whole.
std::optional<std::string> nearest_quantity(std::string_view name, std::span<const std::string_view> valid);

/// What to do so that `name` can become `valid`: "name it 'b_mm'", "convert it to mm and name it 'b_mm'".
std::string renaming(std::string_view name, std::string_view valid);

/// A remedy for an unknown key whose last part may be a unit: "did you mean 'b_mm'?", or that it must be
/// converted, or all valid ones.
std::string suggest_key(std::string_view name, std::span<const std::string_view> valid);

}  // namespace loam::lab_data
