#include "experiments/likelihood_terms.hpp"

#include <algorithm>
#include <cmath>

namespace loam::experiments {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

const surrogate::Prior misfit_prior{surrogate::PriorKind::lognormal, -3.5, 0.5, 2e-5, 0.05};

VectorXd reading_variance(const Observation& observation, const OutputTransform& transform, double misfit) {
    VectorXd out(observation.measured.size());
    for (Index k = 0; k < out.size(); ++k) {
        const double y = observation.measured[k], slope = transform.derivative(std::max(y, 0.0));
        const double sd =
            observation.sd ? (*observation.sd)[k] : std::hypot(observation.floor, observation.relative * y);
        out[k] = (sd * sd + misfit * misfit) * slope * slope;
    }
    return out;
}

void prior_residuals(const ParameterSpace& space, const VectorXd& x, Index first, VectorXd& out,
                     MatrixXd* jacobian) {
    for (Index k = 0; k < space.dimension(); ++k) {
        // A truncated normal's log density has the derivative (mean - x) / sd²; a uniform's is zero.
        const double at0 = space.prior(k).log_density_derivative_unit(0);
        const double curvature = at0 - space.prior(k).log_density_derivative_unit(1);
        const double root = std::sqrt(std::max(curvature, 0.0));
        out[first + k] = curvature > 0 ? root * (x[k] - at0 / curvature) : 0.0;
        if (jacobian) (*jacobian)(first + k, k) = root;
    }
}

}  // namespace loam::experiments
