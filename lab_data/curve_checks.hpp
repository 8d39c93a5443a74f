// What a measured curve must satisfy to be one. Noise is no fault: only what no noise explains is.
#pragma once

#include <map>
#include <string>

#include "lab_data/columns.hpp"
#include "lab_data/sample.hpp"

namespace loam::lab_data {

/// A curve that has been read, with what is needed to say where a number stands.
struct Curve {
    const CsvTable& table;
    const std::map<std::string, Column>& columns;
    const Test& test;  // columns, phase and lines as in the file, in SI
    Faults& faults;

    bool has(const std::string& quantity) const { return columns.contains(quantity); }
    const std::vector<double>& values(const std::string& quantity) const { return test.column(quantity); }
    /// Reports a fault of the number that `quantity` has in reading `row`.
    void error(std::size_t row, const std::string& quantity, std::string constraint,
               std::string remedy) const;
};

/// Checks all columns for size, then what is special to the kind of test.
void check_curve(const Curve& curve);

}  // namespace loam::lab_data
