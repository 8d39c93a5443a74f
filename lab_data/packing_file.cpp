#include "lab_data/packing_file.hpp"

#include <algorithm>
#include <string>

#include "lab_data/csv_table.hpp"
#include "lab_data/number.hpp"
#include "lab_data/text_file.hpp"

namespace loam::lab_data {
namespace {

constexpr std::size_t largest_file = std::size_t{1} << 28;
constexpr std::string_view cell_prefix = "# periodic cell x,y,z in m:";
constexpr std::array<std::string_view, 4> wanted{"x_m", "y_m", "z_m", "radius_m"};

void throw_first(const Faults& faults) {
    if (!faults.errors.empty()) throw faults.errors.front();
}

std::array<double, 3> read_cell(const std::string& text, const std::string& file) {
    std::string_view line = std::string_view(text).substr(0, text.find('\n'));
    const Fault fault{.file = file,
                      .line = 1,
                      .value = std::string(trimmed(line.substr(0, 80))),
                      .constraint = "must give the periodic cell",
                      .remedy = "write # periodic cell x,y,z in m: 1.0,1.0,1.0 with the cell's three sides"};
    if (!line.starts_with(cell_prefix)) throw UserError(fault);
    line.remove_prefix(cell_prefix.size());
    std::array<double, 3> cell{};
    for (int k = 0; k < 3; ++k) {
        const std::size_t comma = line.find(',');
        if ((k < 2) == (comma == std::string_view::npos)) throw UserError(fault);
        const auto number = parse_number(line.substr(0, comma));
        if (!number || *number <= 0) throw UserError(fault);
        cell[static_cast<std::size_t>(k)] = *number;
        if (k < 2) line.remove_prefix(comma + 1);
    }
    return cell;
}

}  // namespace

PackingFile read_packing_file(const std::filesystem::path& path) {
    Faults faults;
    const auto text = read_text(path, largest_file, faults);
    throw_first(faults);
    PackingFile packing;
    packing.cell = read_cell(*text, path.string());
    const auto table = read_csv(path, faults);
    throw_first(faults);
    std::array<std::size_t, 4> column{};
    for (std::size_t c = 0; c < wanted.size(); ++c) {
        const auto at = std::find(table->header.begin(), table->header.end(), wanted[c]);
        if (at == table->header.end())
            throw UserError({.file = path.string(),
                             .line = table->header_line,
                             .column = std::string(wanted[c]),
                             .constraint = "is missing",
                             .remedy = "give the columns x_m,y_m,z_m,radius_m"});
        column[c] = static_cast<std::size_t>(at - table->header.begin());
    }
    double largest = 0;
    for (std::size_t r = 0; r < table->rows.size(); ++r) {
        std::array<double, 4> value{};
        for (std::size_t c = 0; c < 4; ++c) {
            const std::string& cell = table->rows[r].cells[column[c]];
            const auto number = parse_number(cell);
            Fault fault = table->at(r, column[c]);
            if (!number) {
                fault.constraint = "must be a number";
                fault.remedy = number_remedy(cell);
                throw UserError(fault);
            }
            value[c] = *number;
            if (c == 3 && *number <= 0) {
                fault.constraint = "must be positive";
                fault.remedy = "give the sphere's radius in m";
                throw UserError(fault);
            }
        }
        packing.spheres.push_back({{value[0], value[1], value[2]}, value[3]});
        largest = std::max(largest, value[3]);
    }
    if (*std::min_element(packing.cell.begin(), packing.cell.end()) < 4 * largest)
        throw UserError({.file = path.string(),
                         .line = 1,
                         .constraint = "must be at least two of the largest spheres wide in every direction",
                         .remedy = "use a larger cell, or check that cell and radii have the same unit"});
    return packing;
}

}  // namespace loam::lab_data
