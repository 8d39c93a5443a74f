// Made by rank_tests_reference.py; not to be edited.
#pragma once

#include <limits>
#include <vector>

namespace expected {

constexpr double nan = std::numeric_limits<double>::quiet_NaN();
struct Case {
    double statistic, p_value;
};

// clang-format off
inline const std::vector<double> plain_x{1.83, 0.5, 1.62, 2.48, 1.68, 1.88, 1.55, 3.06, 1.3};
inline const std::vector<double> plain_y{0.878, 0.647, 0.598, 2.05, 1.06, 1.29, 1.06001, 3.14, 1.29001};
inline const std::vector<double> ties_x{1.0, 2.0, 2.0, 3.0, 5.0, 5.0, 5.0, 7.0, 9.0, 9.0, 11.0, 12.0};
inline const std::vector<double> ties_y{2.0, 2.0, 4.0, 5.0, 5.0, 8.0, 9.0, 9.0, 13.0, 14.0, 14.0, 15.0};
inline const std::vector<double> small{0.4, 2.2, 1.1};
inline const std::vector<double> long_x{0.0, 1.021665, -0.195541, -0.835815, 0.614113, 0.948487, -0.519875, -0.408137, 1.099162, 0.666741, -0.661397, 0.181001, 1.359793, 0.281363, -0.551798, 0.809058, 1.359273, -0.075637, -0.188361, 1.343328, 1.129083, -0.279667, 0.365328, 1.6756, 0.760693, -0.246087, 0.995987, 1.750429, 0.381675, 0.047676, 1.570229, 1.579613, 0.122373, 0.556234, 1.969404, 1.239115, 0.081863, 1.178094, 2.120589, 0.849219, 0.302072, 1.782167, 2.01564, 0.543112, 0.756824, 2.242012, 1.713314, 0.432097, 1.358681, 2.468858, 1.323924, 0.576515, 1.981778, 2.434798, 0.980527, 0.969988, 2.494705, 2.180072, 0.804163, 1.541083};
inline const std::vector<double> long_y{1.0, -0.656276, -0.092153, 0.845725, -0.934844, 0.533305, 0.390815, -0.854133, 0.98064, -0.186017, -0.432833, 1.096045, -0.661123, 0.184842, 0.848043, -0.848346, 0.782305, 0.339092, -0.667629, 1.150418, -0.232178, -0.174518, 1.164569, -0.644169, 0.460306, 0.830599, -0.733985, 1.013937, 0.282649, -0.457468, 1.29339, -0.266277, 0.094528, 1.20673, -0.602816, 0.729622, 0.79695, -0.591881, 1.224806, 0.226133, -0.226444, 1.408637, -0.284291, 0.369868, 1.22442, -0.535149, 0.988342, 0.751106, -0.42293, 1.412095, 0.17419, 0.022063, 1.496011, -0.282649, 0.646886, 1.220218, -0.439986, 1.232315, 0.697416, -0.228779};
inline const std::vector<double> missing{2.5, nan, 0.7, 4.1, nan, 3.3, 2.0, 5.2, 1.4};
constexpr Case mann_whitney_plain{58.0, 0.1333202155896274};
constexpr Case mann_whitney_ties{51.0, 0.23237611822348714};
constexpr Case mann_whitney_small{13.0, 1.0};
constexpr Case mann_whitney_long{2483.0, 0.0003407180157338056};
constexpr Case mann_whitney_missing{51.0, 0.04178321678321679};
constexpr Case wilcoxon_plain{5.0, 0.0390625};
constexpr Case wilcoxon_ties{0.0, 0.004808563078561355};
constexpr Case wilcoxon_long{418.0, 0.0002534813647157241};
constexpr Case wilcoxon_missing{0.0, 0.015625};
constexpr Case kruskal_plain{2.6724386724386733, 0.26283749271105566};
constexpr Case kruskal_ties{6.72168985059248, 0.03470592264102253};
constexpr Case kruskal_missing{11.49159318048206, 0.0031961874855342804};
constexpr Case spearman_plain{0.5833333333333334, 0.09918581647988323};
constexpr Case spearman_ties{0.9715364011314266, 1.402763863937824e-07};
constexpr Case spearman_long{0.07474298416226731, 0.5703252269261923};
constexpr Case spearman_missing{0.7500000000000002, 0.05218140045705776};
// clang-format on

}  // namespace expected
