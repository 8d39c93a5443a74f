// A packing of another program: spheres in a periodic cell, as the packing files of the command line hold it.
#pragma once

#include <array>
#include <filesystem>
#include <vector>

#include "lab_data/user_error.hpp"

namespace loam::lab_data {

struct PackingSphere {
    std::array<double, 3> centre;  // m
    double radius;                 // m
};

struct PackingFile {
    std::array<double, 3> cell;  // sides of the periodic cell (m)
    std::vector<PackingSphere> spheres;
};

/// Reads a file whose first line is `# periodic cell x,y,z in m: 1,1,1`, then a table with the columns
/// x_m,y_m,z_m,radius_m. Throws UserError with the first fault: file, line, column, value, remedy. A cell
/// side or radius that is not positive is a fault, and so is a cell narrower than two of the largest spheres.
PackingFile read_packing_file(const std::filesystem::path& path);

}  // namespace loam::lab_data
