/// A mixture of multivariate t distributions fitted to points: the posterior sampler's guess of its target.
/// Inside this library only.
#pragma once

#include <vector>

#include "optimizers/problem.hpp"
#include "optimizers/random.hpp"

namespace loam::optimizers {

/// Location and spread are those of a mixture of normals, fitted by expectation maximisation (Dempster, Laird
/// & Rubin 1977, J. R. Stat. Soc. B 39, 1-38); the tails are those of a t with 5 degrees of freedom, so that
/// a proposal covers its target.
class TMixture {
  public:
    /// points: [k x m], m >= 2. The number of components, 1, 2, 4, … up to `most`, is the last that lowers
    /// Schwarz's (1978) criterion, and small enough to leave each component 4 (k + 1) points on average.
    TMixture(const Matrix& points, int most, Random& random);

    /// Up to log_constant(), which is the same at every point and for every mixture of that dimension.
    double log_density(const Vector& point) const;
    static double log_constant(Eigen::Index dimension);
    Vector draw(Random& random) const;

  private:
    struct Component {
        double weight;
        Vector mean;
        Matrix root;  ///< lower Cholesky factor of the scale matrix
    };
    struct Fit {
        std::vector<Component> components;
        double log_likelihood;
    };
    static Component component(const Matrix& points, const Vector& share, const Vector& floor);
    static Matrix log_densities(const Matrix& points, const std::vector<Component>& components);
    static Fit fit(const Matrix& points, int count, Random& random);

    std::vector<Component> components_;
    // For log_density(): the inverse roots under each other, what they make of the means, and what does not
    // depend on x.
    Matrix whitening_;
    Vector white_means_, log_factors_;
};

}  // namespace loam::optimizers
