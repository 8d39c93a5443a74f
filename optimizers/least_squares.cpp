#include "optimizers/least_squares.hpp"

#include <ceres/ceres.h>

#include <chrono>
#include <cmath>
#include <exception>
#include <stdexcept>

#include "optimizers/scaled_box.hpp"

namespace loam::optimizers {

namespace {

using RowMajor = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;

/// One evaluation: where, and what came of it.
struct Point {
    Vector x, residuals;
    Matrix jacobian;  ///< 0 x 0 if it was not asked for
    double value = std::numeric_limits<double>::infinity();
};

/// The residuals within their budget, with what they throw caught and the best point kept.
class GuardedResiduals {
  public:
    /// Evaluates the start, which fixes the number of residuals. Throws what the residuals throw, and
    /// std::runtime_error when they are not finite there.
    GuardedResiduals(const Residuals& residuals, const Vector& start, const Options& options)
        : residuals_(residuals), options_(options) {
        best_ = call(start, true);
        size_ = best_.residuals.size();
        if (!std::isfinite(best_.value)) {
            throw std::runtime_error(
                "optimizers: no least-squares fit, because the residuals (or their Jacobian) are not finite "
                "at the start");
        }
    }

    /// The residuals at x, or nothing when they are not finite there, throw, or may not be called any more.
    std::optional<Point> evaluate(const Vector& x, bool with_jacobian) noexcept {
        try {
            if (x == best_.x && (!with_jacobian || best_.jacobian.size() > 0)) return best_;
            if (stopped()) return std::nullopt;
            Point point = call(x, with_jacobian);
            if (!std::isfinite(point.value)) return std::nullopt;
            if (point.value < best_.value || x == best_.x) best_ = point;
            return point;
        } catch (...) {
            error_ = std::current_exception();
            return std::nullopt;
        }
    }

    /// One evaluation is held back for the Jacobian at the best point.
    bool stopped() const { return error_ || evaluations_ + 1 >= options_.max_evaluations || out_of_time(); }
    bool out_of_time() const { return options_.max_seconds > 0 && seconds() >= options_.max_seconds; }
    double seconds() const {
        return std::chrono::duration<double>(std::chrono::steady_clock::now() - began_).count();
    }
    int evaluations() const { return evaluations_; }
    Eigen::Index size() const { return size_; }

    /// The best point with its Jacobian; rethrows what the residuals threw.
    const Point& best() {
        if (error_) std::rethrow_exception(error_);
        if (best_.jacobian.size() == 0) best_ = call(best_.x, true);
        return best_;
    }

  private:
    Point call(const Vector& x, bool with_jacobian) {
        // What is left unfilled must not pass for a result.
        constexpr double unset = std::numeric_limits<double>::quiet_NaN();
        Point point{x, Vector::Constant(size_, unset), {}};
        if (with_jacobian) point.jacobian.setConstant(size_, x.size(), unset);
        ++evaluations_;
        residuals_(x, point.residuals, with_jacobian ? &point.jacobian : nullptr);
        check_shape(point, with_jacobian);
        if (point.residuals.allFinite() && point.jacobian.allFinite()) {
            point.value = 0.5 * point.residuals.squaredNorm();
        }
        return point;
    }

    void check_shape(const Point& point, bool with_jacobian) const {
        const Eigen::Index m = point.residuals.size();
        if (m == 0 || (size_ > 0 && m != size_)) {
            throw std::invalid_argument(
                "optimizers: there are " + std::to_string(m) +
                " residuals, but there must be the same number, at least 1, at every x");
        }
        if (with_jacobian && (point.jacobian.rows() != m || point.jacobian.cols() != point.x.size())) {
            throw std::invalid_argument(
                "optimizers: the Jacobian is " + std::to_string(point.jacobian.rows()) + " x " +
                std::to_string(point.jacobian.cols()) + ", but it must be residuals x variables");
        }
    }

    const Residuals& residuals_;
    const Options& options_;
    Point best_;
    Eigen::Index size_ = 0;
    int evaluations_ = 0;
    std::exception_ptr error_;
    std::chrono::steady_clock::time_point began_ = std::chrono::steady_clock::now();
};

/// The guarded residuals as Ceres calls them, on the scaled box.
class ScaledResiduals : public ceres::CostFunction {
  public:
    ScaledResiduals(GuardedResiduals& guarded, const ScaledBox& box) : guarded_(guarded), box_(box) {
        mutable_parameter_block_sizes()->push_back(static_cast<int>(box.size()));
        set_num_residuals(static_cast<int>(guarded.size()));
    }

    bool Evaluate(double const* const* parameters, double* residuals, double** jacobians) const override {
        double* jacobian = jacobians ? jacobians[0] : nullptr;
        const Vector x = box_.to_x(Eigen::Map<const Vector>(parameters[0], box_.size()));
        const std::optional<Point> point = guarded_.evaluate(x, jacobian != nullptr);
        if (!point) return false;
        Eigen::Map<Vector>(residuals, guarded_.size()) = point->residuals;
        if (!jacobian) return true;
        Eigen::Map<RowMajor> scaled(jacobian, guarded_.size(), box_.size());
        for (Eigen::Index j = 0; j < box_.size(); ++j) {
            scaled.col(j) = point->jacobian.col(box_.free()[static_cast<std::size_t>(j)]) * box_.width(j);
        }
        return true;
    }

  private:
    GuardedResiduals& guarded_;
    const ScaledBox& box_;
};

ceres::Solver::Options solver_options(const Options& options) {
    ceres::Solver::Options solver;
    solver.trust_region_strategy_type = ceres::LEVENBERG_MARQUARDT;
    solver.linear_solver_type = ceres::DENSE_QR;
    solver.num_threads = 1;
    solver.logging_type = ceres::SILENT;
    solver.max_num_iterations = options.max_evaluations;
    solver.max_num_consecutive_invalid_steps = 20;
    solver.function_tolerance = options.relative_tolerance;
    solver.parameter_tolerance = options.relative_tolerance;
    // Absolute in the solver, so that it would depend on the scale of the residuals: only a true zero counts.
    solver.gradient_tolerance = 0;
    return solver;
}

/// Ceres' message up to its numbers: "Function tolerance reached", say.
std::string first_sentence(const std::string& message) {
    return message.substr(0, message.find_first_of(".:"));
}

/// One run of the solver over `bounds` from the best point; the message and whether a tolerance was met.
Summary solve(GuardedResiduals& guarded, const Bounds& bounds, const Options& options) {
    Summary summary;
    const ScaledBox box(bounds);
    if (box.size() == 0) {
        summary.stopped_by = "all variables are fixed";
        summary.converged = true;
        return summary;
    }
    ScaledResiduals cost(guarded, box);
    ceres::Problem::Options ownership;
    ownership.cost_function_ownership = ceres::DO_NOT_TAKE_OWNERSHIP;
    ceres::Problem problem(ownership);
    Vector z = box.to_z(guarded.best().x);
    problem.AddResidualBlock(&cost, nullptr, z.data());
    for (int j = 0; j < static_cast<int>(box.size()); ++j) {
        problem.SetParameterLowerBound(z.data(), j, 0.0);
        problem.SetParameterUpperBound(z.data(), j, 1.0);
    }
    ceres::Solver::Summary report;
    ceres::Solve(solver_options(options), &problem, &report);
    summary.converged = report.termination_type == ceres::CONVERGENCE;
    summary.stopped_by = first_sentence(report.message);
    if (!summary.converged && guarded.stopped()) {
        summary.stopped_by = guarded.out_of_time() ? "max_seconds reached" : "max_evaluations reached";
    }
    return summary;
}

/// `bounds` with every variable fixed that lies on a bound and would have to cross it to lower the value.
Bounds held_at_active(const Bounds& bounds, const Point& point) {
    const Vector slope = point.jacobian.transpose() * point.residuals;
    Bounds held = bounds;
    for (Eigen::Index i = 0; i < bounds.size(); ++i) {
        const double x = point.x(i);
        if ((x == bounds.lower(i) && slope(i) > 0) || (x == bounds.upper(i) && slope(i) < 0)) {
            held.lower(i) = held.upper(i) = x;
        }
    }
    return held;
}

/// Ceres cuts a step at the bounds instead of solving for the best step inside them, and along a bound it may
/// stall far from the minimum. So the solver is run again with the active bounds held, until that gains
/// nothing.
Summary solve_with_active_bounds(GuardedResiduals& guarded, const Bounds& bounds, const Options& options) {
    Summary summary = solve(guarded, bounds, options);
    for (bool gained = true; gained && !guarded.stopped();) {
        const double before = guarded.best().value;
        summary = solve(guarded, held_at_active(bounds, guarded.best()), options);
        if (guarded.stopped()) break;
        gained = before - guarded.best().value > options.relative_tolerance * before;
    }
    return summary;
}

}  // namespace

LeastSquares minimise_least_squares(const Residuals& residuals, const Bounds& bounds, const Vector& start,
                                    const Options& options) {
    bounds.validate();
    options.validate();
    validate_start(start, bounds);
    GuardedResiduals guarded(residuals, bounds.clamp(start), options);
    LeastSquares result;
    result.minimum.summary = solve_with_active_bounds(guarded, bounds, options);
    const Point& best = guarded.best();
    result.minimum.x = best.x;
    result.minimum.value = best.value;
    result.minimum.summary.evaluations = guarded.evaluations();
    result.minimum.summary.seconds = guarded.seconds();
    result.residuals = best.residuals;
    result.jacobian = best.jacobian;
    return result;
}

std::optional<Matrix> covariance(const Matrix& jacobian) {
    const Vector scale = jacobian.colwise().norm();
    if (jacobian.rows() < jacobian.cols() || !(scale.minCoeff() > 0) || !scale.allFinite())
        return std::nullopt;
    const Vector inverse_scale = scale.cwiseInverse();
    const Eigen::JacobiSVD<Matrix> svd(jacobian * inverse_scale.asDiagonal(), Eigen::ComputeThinV);
    const Vector& singular = svd.singularValues();
    if (singular(singular.size() - 1) <= 1e-10 * singular(0)) return std::nullopt;
    const Matrix root = inverse_scale.asDiagonal() * svd.matrixV() * singular.cwiseInverse().asDiagonal();
    return root * root.transpose();
}

}  // namespace loam::optimizers
