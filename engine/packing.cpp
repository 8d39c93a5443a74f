#include "engine/packing.hpp"

#include <Eigen/LU>
#include <stdexcept>

namespace loam::engine {

double Packing::porosity() const {
    return 1.0 - solid_volume() / cell.determinant();
}

double Packing::solid_volume() const {
    return 4.0 / 3.0 * 3.14159265358979323846 * radii.array().cube().sum();
}

double Packing::void_ratio() const {
    const double n = porosity();
    return n / (1.0 - n);
}

void validate(const Packing& packing) {
    if (packing.radii.size() == 0) throw std::invalid_argument("packing: has no particles");
    if (packing.centres.cols() != packing.radii.size())
        throw std::invalid_argument("packing: centres and radii differ in number");
    if (!packing.centres.allFinite() || !packing.radii.allFinite() || !packing.cell.allFinite())
        throw std::invalid_argument("packing: every coordinate, radius and cell side must be finite");
    if (packing.radii.minCoeff() <= 0)
        throw std::invalid_argument("packing: every radius must be positive (m)");
    if (packing.cell.determinant() <= 0)
        throw std::invalid_argument("packing: the cell's volume must be positive");
    const double reach = 2 * packing.radii.maxCoeff();
    const Eigen::Matrix3d inverse = packing.cell.inverse();
    for (int k = 0; k < 3; ++k)
        if (1.0 / inverse.row(k).norm() < 2 * reach)
            throw std::invalid_argument(
                "packing: the cell must be at least two of the largest particles wide");
}

}  // namespace loam::engine
