#include "surrogate/dense/dense_functions.hpp"

namespace loam::surrogate {

const DenseFunctions dense_baseline{invert_factor, gram, multiply, multiply_many};

}  // namespace loam::surrogate
