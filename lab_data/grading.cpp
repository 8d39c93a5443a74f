#include <algorithm>
#include <array>

#include "lab_data/columns.hpp"
#include "lab_data/csv_table.hpp"
#include "lab_data/curve.hpp"

namespace loam::lab_data {
namespace {

constexpr std::array grading_quantities{
    Quantity{"sieve", Dimension::length, true},
    Quantity{"passing", Dimension::ratio, true},
};

struct Reading {
    std::size_t row;
    GradingPoint point;
};

/// What is wrong with a reading after the next finer one; an empty constraint if nothing is.
Fault fault_of(const Reading& reading, const std::vector<GradingPoint>& finer, const CsvTable& table,
               const Column& sieve, const Column& passing) {
    const auto fault = [&](const Column& column, std::string constraint, std::string remedy) {
        Fault made = table.at(reading.row, column.index);
        made.constraint = std::move(constraint);
        made.remedy = std::move(remedy);
        return made;
    };
    const GradingPoint& point = reading.point;
    if (point.sieve <= 0 || point.sieve > 1)
        return fault(sieve, "must be above 0 and at most 1 m",
                     "give the sieve's opening in the unit of the name");
    if (point.passing < 0 || point.passing > 1)
        return fault(passing, "must be from 0 to 100 %",
                     "name the column passing_percent if it is in percent, passing if it is a ratio");
    if (finer.empty()) return {};
    if (point.sieve == finer.back().sieve)
        return fault(sieve, "is there twice", "keep one row for each sieve");
    if (point.passing < finer.back().passing)
        return fault(passing, "is less than what passes the next finer sieve",
                     "give what passes each sieve, not what it retains");
    return {};
}

}  // namespace

std::vector<GradingPoint> read_grading(const std::filesystem::path& path, Faults& faults) {
    const auto table = read_csv(path, faults);
    if (!table) return {};
    const auto columns = find_columns(*table, grading_quantities, faults);
    if (columns.size() < grading_quantities.size()) return {};
    const Column &sieve = columns.at("sieve"), &passing = columns.at("passing");
    const auto sieves = read_numbers(*table, sieve, faults);
    const auto passes = read_numbers(*table, passing, faults);
    if (!sieves || !passes) return {};
    std::vector<Reading> readings;
    for (std::size_t i = 0; i < sieves->size(); ++i) readings.push_back({i, {(*sieves)[i], (*passes)[i]}});
    std::ranges::stable_sort(readings, {}, [](const Reading& reading) { return reading.point.sieve; });
    std::vector<GradingPoint> grading;
    RepeatedFault bad(faults, table->file);
    for (const Reading& reading : readings) {
        Fault fault = fault_of(reading, grading, *table, sieve, passing);
        if (fault.constraint.empty())
            grading.push_back(reading.point);
        else
            bad.error(std::move(fault));
    }
    if (!grading.empty() && grading.back().passing < 0.995)
        faults.warn(table->file, "less than all of the soil passes the largest sieve");
    return grading;
}

}  // namespace loam::lab_data
