#include "surrogate/dense/dense_functions.hpp"

namespace loam::surrogate {

const DenseFunctions dense_avx2 = functions;

}  // namespace loam::surrogate
