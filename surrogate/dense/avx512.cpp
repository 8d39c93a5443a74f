#include "surrogate/dense/dense_functions.hpp"

namespace loam::surrogate {

const DenseFunctions dense_avx512 = functions;

}  // namespace loam::surrogate
