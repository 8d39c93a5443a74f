#include "surrogate/dense/dense_functions.hpp"

namespace loam::surrogate {

const DenseFunctions dense_baseline = functions;

}  // namespace loam::surrogate
