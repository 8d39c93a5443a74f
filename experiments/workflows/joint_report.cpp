#include "experiments/workflows/joint_report.hpp"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>

#include "experiments/cross_test.hpp"
#include "experiments/ensemble/run_seed.hpp"
#include "surrogate/designs.hpp"

namespace loam::experiments {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;
using lab_data::TestKind;
using nlohmann::json;

constexpr Index prior_points = 4096, posterior_points = 1000;

/// A fitted test: where its readings stand among the fitted ones.
struct FittedTest {
    const lab_data::Test* test;
    Index first, count;
};

std::vector<FittedTest> fitted_tests(const Campaign& campaign, const Calibration& c) {
    std::vector<FittedTest> out;
    for (const CampaignTest& test : campaign.tests()) {
        const auto at = std::ranges::find(c.columns, test.first);
        if (at != c.columns.end()) out.push_back({test.test, at - c.columns.begin(), test.outputs()});
    }
    return out;
}

/// Readings of one kind, with what the emulator must be off by to count 1.
struct KindOfTest {
    TestKind kind;
    std::vector<Index> readings;
    std::vector<double> tolerable;  // SI
};

std::vector<KindOfTest> fitted_kinds(const Campaign& campaign, const Observation& observation) {
    std::vector<KindOfTest> out;
    for (const ObservedCurve& curve : observation.curves) {
        const TestKind kind = campaign.tests()[static_cast<std::size_t>(curve.test)].test->kind;
        auto at = std::ranges::find(out, kind, &KindOfTest::kind);
        if (at == out.end()) at = out.insert(out.end(), {kind, {}, {}});
        for (Index k = curve.first; k < curve.first + curve.count; ++k) {
            at->readings.push_back(k);
            at->tolerable.push_back(curve.unit * curve.tolerable_difference);
        }
    }
    return out;
}

double error_of(const KindOfTest& kind, const VectorXd& simulated, const VectorXd& measured) {
    double squares = 0;
    for (std::size_t k = 0; k < kind.readings.size(); ++k)
        squares +=
            std::pow((simulated[kind.readings[k]] - measured[kind.readings[k]]) / kind.tolerable[k], 2);
    return std::sqrt(squares / static_cast<double>(kind.readings.size()));
}

VectorXd emulated(const Calibration& c, const VectorXd& x) {
    VectorXd out = c.trained->emulator.predict_mean(x);
    for (Index k = 0; k < out.size(); ++k)
        out[k] = c.trained->transforms[static_cast<std::size_t>(k)].inverse(out[k]);
    return out;
}

/// Points of the unit cube to choose from: the estimate first.
MatrixXd candidates(const Campaign& campaign, const Calibration& c) {
    const Index d = campaign.space().dimension(), draws = c.fit.posterior.draws.rows(),
                n = std::min(posterior_points, draws);
    const std::uint64_t seed = run_seed(campaign.settings().seed, 0, 15);
    MatrixXd out(1 + n + prior_points, d);
    out.row(0) = c.fit.estimate.transpose();
    for (Index k = 0; k < n; ++k) out.row(1 + k) = c.fit.posterior.draws.row(k * draws / n).head(d);
    out.bottomRows(prior_points) = surrogate::sobol_sequence(prior_points, d, {.seed = seed});
    return out;
}

/// The rows of errors [n x 2] that no other row beats in both, by rising first column.
std::vector<Index> front(const MatrixXd& errors) {
    std::vector<Index> order(static_cast<std::size_t>(errors.rows())), out;
    for (std::size_t k = 0; k < order.size(); ++k) order[k] = static_cast<Index>(k);
    std::ranges::sort(order, [&](Index a, Index b) {
        return std::pair(errors(a, 0), errors(a, 1)) < std::pair(errors(b, 0), errors(b, 1));
    });
    for (const Index k : order)
        if (out.empty() || errors(k, 1) < errors(out.back(), 1)) out.push_back(k);
    return out;
}

}  // namespace

json identification_document(const Campaign& campaign, const Calibration& c) {
    const ParameterSpace& space = campaign.space();
    const Index d = space.dimension();
    VectorXd precision, mean;
    prior_as_normal(space, precision, mean);
    precision = (precision.array() > 0).select(precision, 12);  // a uniform prior has the variance 1/12
    MatrixXd slope;
    c.trained->emulator.predict_mean(c.fit.estimate, &slope);
    json out{{"names", json::array()}, {"files", json::array()}, {"sd_over_prior", json::array()}};
    for (Index k = 0; k < d; ++k) out["names"].push_back(space.info(k).name);
    for (const FittedTest& test : fitted_tests(campaign, c)) {
        const MatrixXd j = slope.middleRows(test.first, test.count);
        const MatrixXd s = c.fit.covariance.block(test.first, test.first, test.count, test.count);
        MatrixXd information = j.transpose() * s.llt().solve(j);
        information.diagonal() += precision;
        const VectorXd variance = information.llt().solve(MatrixXd::Identity(d, d)).diagonal();
        const VectorXd ratio = (variance.array() * precision.array()).sqrt();
        out["files"].push_back(test.test->file);
        out["sd_over_prior"].push_back(std::vector<double>(ratio.begin(), ratio.end()));
    }
    return out;
}

json trade_off_document(const Campaign& campaign, const Calibration& c) {
    std::vector<Index> columns;
    const Observation observation = observation_of(campaign, columns);
    const std::vector<KindOfTest> kinds = fitted_kinds(campaign, observation);
    json out = json::array();
    if (kinds.size() < 2 || columns != c.columns) return out;
    const MatrixXd x = candidates(campaign, c);
    MatrixXd errors(x.rows(), static_cast<Index>(kinds.size()));
    for (Index row = 0; row < x.rows(); ++row) {
        const VectorXd simulated = emulated(c, x.row(row).transpose());
        for (std::size_t k = 0; k < kinds.size(); ++k)
            errors(row, static_cast<Index>(k)) = error_of(kinds[k], simulated, observation.measured);
    }
    for (std::size_t a = 0; a < kinds.size(); ++a)
        for (std::size_t b = a + 1; b < kinds.size(); ++b) {
            MatrixXd pair(x.rows(), 2);
            pair << errors.col(static_cast<Index>(a)), errors.col(static_cast<Index>(b));
            json points = json::array();
            for (const Index row : front(pair)) points.push_back({pair(row, 0), pair(row, 1)});
            out.push_back({{"kinds", {to_string(kinds[a].kind), to_string(kinds[b].kind)}},
                           {"front", points},
                           {"estimate", {pair(0, 0), pair(0, 1)}}});
        }
    return out;
}

}  // namespace loam::experiments
