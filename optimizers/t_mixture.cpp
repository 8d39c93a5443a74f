#include "optimizers/t_mixture.hpp"

#include <cmath>
#include <limits>
#include <numbers>

namespace loam::optimizers {

namespace {

constexpr int degrees_of_freedom = 5;
constexpr int most_iterations = 40;

/// log(sum(exp(terms))).
double log_sum(const Eigen::Ref<const Vector>& terms) {
    const double top = terms.maxCoeff();
    return std::isfinite(top) ? top + std::log((terms.array() - top).exp().sum()) : top;
}

double log_determinant(const Matrix& triangular) {
    return triangular.diagonal().array().log().sum();
}

/// First clusters: centres drawn with chance in proportion to the squared distance from those already chosen
/// (k-means++; Arthur & Vassilvitskii 2007), each point counted to the nearest. [count x m], ones and zeros.
Matrix first_shares(const Matrix& points, int count, Random& random) {
    const Eigen::Index m = points.cols();
    Vector nearest = Vector::Constant(m, std::numeric_limits<double>::infinity());
    Eigen::VectorXi owner = Eigen::VectorXi::Zero(m);
    Eigen::Index centre = random.index(m);
    for (int c = 0; c < count; ++c) {
        for (Eigen::Index i = 0; i < m; ++i) {
            const double distance = (points.col(i) - points.col(centre)).squaredNorm();
            if (distance >= nearest(i)) continue;
            nearest(i) = distance;
            owner(i) = c;
        }
        double left = random.uniform() * nearest.sum();
        for (centre = 0; centre + 1 < m && left >= nearest(centre); ++centre) left -= nearest(centre);
    }
    Matrix shares = Matrix::Zero(count, m);
    for (Eigen::Index i = 0; i < m; ++i) shares(owner(i), i) = 1;
    return shares;
}

}  // namespace

TMixture::Component TMixture::component(const Matrix& points, const Vector& share, const Vector& floor) {
    const double total = share.sum();
    Component result{total / static_cast<double>(points.cols()), points * share / total, {}};
    const Matrix centred = points.colwise() - result.mean;
    Matrix covariance = centred * share.asDiagonal() * centred.transpose() / total;
    covariance.diagonal() += floor;
    result.root = covariance.llt().matrixL();
    return result;
}

/// Of each point [column] under each normal component [row], with its weight.
Matrix TMixture::log_densities(const Matrix& points, const std::vector<Component>& components) {
    Matrix logs(static_cast<Eigen::Index>(components.size()), points.cols());
    for (Eigen::Index c = 0; c < logs.rows(); ++c) {
        const Component& part = components[static_cast<std::size_t>(c)];
        const Matrix white = part.root.triangularView<Eigen::Lower>().solve(points.colwise() - part.mean);
        logs.row(c) =
            std::log(part.weight) - log_determinant(part.root) - 0.5 * white.colwise().squaredNorm().array();
    }
    return logs;
}

TMixture::Fit TMixture::fit(const Matrix& points, int count, Random& random) {
    const auto m = static_cast<double>(points.cols());
    const Vector variance = (points.colwise() - points.rowwise().mean()).rowwise().squaredNorm() / m;
    // Points in a plane, or copies of one, must not make a component singular.
    const Vector floor = 1e-6 * variance.array() + 1e-30;
    Matrix shares = first_shares(floor.cwiseSqrt().cwiseInverse().asDiagonal() * points, count, random);
    Fit result{{}, -std::numeric_limits<double>::infinity()};
    for (int iteration = 0; iteration < most_iterations; ++iteration) {
        std::vector<Component> components;
        for (const auto& share : shares.rowwise()) {
            if (count > 1 && share.sum() < static_cast<double>(points.rows() + 1))
                continue;  // too few to span the space
            components.push_back(component(points, share.transpose(), floor));
        }
        if (components.empty()) break;
        Matrix logs = log_densities(points, components);
        double log_likelihood = 0;
        for (auto&& column : logs.colwise()) {
            const double total = log_sum(column);
            column.array() -= total;
            log_likelihood += total;
        }
        const double gain = log_likelihood - result.log_likelihood;
        result = {std::move(components), log_likelihood};
        if (gain < 5e-3 * m) break;
        shares = logs.array().exp();
    }
    return result;
}

TMixture::TMixture(const Matrix& points, int most, Random& random) {
    const Eigen::Index k = points.rows();
    const auto m = static_cast<double>(points.cols()), dimension = static_cast<double>(k);
    double least = std::numeric_limits<double>::infinity();
    for (int count = 1; count <= most && (count == 1 || m >= 4 * (dimension + 1) * count); count *= 2) {
        Fit candidate = fit(points, count, random);
        const double freedom = static_cast<double>(candidate.components.size()) *
                               (1 + dimension + 0.5 * dimension * (dimension + 1));
        const double criterion = freedom * std::log(m) - 2 * candidate.log_likelihood;
        if (count > 1 && !(criterion < least)) break;
        least = criterion;
        components_ = std::move(candidate.components);
    }
    const auto size = static_cast<Eigen::Index>(components_.size());
    whitening_.resize(size * k, k);
    white_means_.resize(size * k);
    log_factors_.resize(size);
    for (Eigen::Index c = 0; c < size; ++c) {
        const Component& part = components_[static_cast<std::size_t>(c)];
        const Matrix inverse = part.root.triangularView<Eigen::Lower>().solve(Matrix::Identity(k, k));
        whitening_.middleRows(c * k, k) = inverse;
        white_means_.segment(c * k, k) = inverse * part.mean;
        log_factors_(c) = std::log(part.weight) - log_determinant(part.root);
    }
}

double TMixture::log_constant(Eigen::Index dimension) {
    const double nu = degrees_of_freedom, k = static_cast<double>(dimension);
    return std::lgamma(0.5 * (nu + k)) - std::lgamma(0.5 * nu) - 0.5 * k * std::log(nu * std::numbers::pi);
}

double TMixture::log_density(const Vector& point) const {
    const Eigen::Index k = point.size();
    const double power = 0.5 * static_cast<double>(degrees_of_freedom + k);
    const Vector white = whitening_ * point - white_means_;
    Vector logs = log_factors_;
    for (Eigen::Index c = 0; c < logs.size(); ++c) {
        logs(c) -= power * std::log1p(white.segment(c * k, k).squaredNorm() / degrees_of_freedom);
    }
    return log_sum(logs);
}

Vector TMixture::draw(Random& random) const {
    double left = random.uniform();
    std::size_t chosen = 0;
    for (; chosen + 1 < components_.size() && left >= components_[chosen].weight; ++chosen) {
        left -= components_[chosen].weight;
    }
    const Component& part = components_[chosen];
    Vector normal(part.mean.size());
    for (double& entry : normal) entry = random.normal();
    double chi_squared = 0;
    for (int i = 0; i < degrees_of_freedom; ++i) {
        const double entry = random.normal();
        chi_squared += entry * entry;
    }
    return part.mean + part.root * normal * std::sqrt(degrees_of_freedom / chi_squared);
}

}  // namespace loam::optimizers
