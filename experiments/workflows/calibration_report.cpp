#include "experiments/workflows/calibration_report.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "experiments/ensemble/run_seed.hpp"
#include "experiments/output/json_values.hpp"
#include "experiments/quantile.hpp"
#include "experiments/settings/writing.hpp"
#include "experiments/workflows/joint_report.hpp"
#include "experiments/workflows/result_json.hpp"
#include "surrogate/sensitivity.hpp"

namespace loam::experiments {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;
using nlohmann::json;

constexpr Index shown_draws = 1000, band_draws = 300;

std::string stage_label(const OutputColumn& column) {
    if (column.x_unit == "Pa") return fmt::format("{:.4g} kPa", column.x / 1000);
    if (column.x_unit == "m")
        return fmt::format("{} {} at {:.3g} mm", column.file, column.channel, 1000 * column.x);
    return fmt::format("{} {} at {:.2g} %", column.file, column.channel, 100 * column.x);
}

/// Place of output `at` among the fitted ones, or -1 where it is held out.
Index fitted_place(const Calibration& c, Index at) {
    const auto found = std::ranges::find(c.columns, at);
    return found == c.columns.end() ? -1 : found - c.columns.begin();
}

const OutputTransform& transform_at(const Calibration& c, Index m) {
    return c.trained->transforms[static_cast<std::size_t>(m)];
}

/// Curves of draws of the posterior, SI, [draws x fitted outputs]: emulator mean at every draw.
MatrixXd posterior_curves(const Calibration& c, Index dimension) {
    const MatrixXd& draws = c.fit.posterior.draws;
    const Index n = std::min(band_draws, draws.rows());
    MatrixXd out(n, static_cast<Index>(c.columns.size()));
    for (Index k = 0; k < n; ++k) {
        const VectorXd x = draws.row(k * draws.rows() / n).head(dimension).transpose();
        const VectorXd mean = c.trained->emulator.predict_mean(x);
        for (Index m = 0; m < mean.size(); ++m) out(k, m) = transform_at(c, m).inverse(mean[m]);
    }
    return out;
}

void add_bands(json& tests, const Campaign& campaign, const Calibration& c) {
    const MatrixXd curves = posterior_curves(c, campaign.space().dimension());
    const auto column = [&](Index m, double q) {
        const VectorXd values = curves.col(m);
        return quantile({values.begin(), values.end()}, q);
    };
    const std::vector<CampaignCurve> drawn = campaign.curves();
    for (std::size_t t = 0; t < drawn.size(); ++t) {
        const CampaignCurve& curve = drawn[t];
        if (curve.test->held_out) continue;
        json low = json::array(), high = json::array(), sd = json::array();
        for (Index k = 0; k < curve.count(); ++k) {
            const Index m = fitted_place(c, curve.first + k);
            const double y = c.simulated[curve.first + k];
            low.push_back(column(m, 0.05));
            high.push_back(column(m, 0.95));
            sd.push_back(std::sqrt(c.fit.covariance(m, m)) / transform_at(c, m).derivative(y));
        }
        tests[t]["band_lower"] = low;
        tests[t]["band_upper"] = high;
        tests[t]["residual_sd"] = sd;
    }
}

json parameters_document(const std::vector<ParameterSummary>& parameters) {
    json out = json::array();
    for (const ParameterSummary& p : parameters) {
        json entry{{"name", p.name},       {"symbol", p.symbol},     {"unit", p.unit},
                   {"meaning", p.meaning}, {"estimate", p.estimate}, {"fixed", p.fixed},
                   {"log", p.logarithmic}};
        if (!p.fixed)
            entry.update({{"q05", p.q05},
                          {"q50", p.q50},
                          {"q95", p.q95},
                          {"prior_q05", p.prior_q05},
                          {"prior_q95", p.prior_q95},
                          {"identified", p.identified}});
        out.push_back(std::move(entry));
    }
    return out;
}

json posterior_document(const Campaign& campaign, const Calibration& c) {
    const ParameterSpace& space = campaign.space();
    const optimizers::Posterior& posterior = c.fit.posterior;
    const Index n = std::min(shown_draws, posterior.draws.rows()), d = space.dimension();
    json out{{"names", json::array()},
             {"symbols", json::array()},
             {"log", json::array()},
             {"draws", json::array()},
             {"prior_density", json::array()},
             {"r_hat", values_of(posterior.rhat.head(d))},
             {"ess", values_of(posterior.ess_bulk.head(d))}};
    for (Index k = 0; k < d; ++k) {
        out["names"].push_back(space.info(k).name);
        out["symbols"].push_back(space.info(k).symbol);
        out["log"].push_back(space.is_logarithmic(k));
        json x = json::array(), density = json::array();
        for (int s = 0; s <= 100; ++s) {
            x.push_back(space.prior(k).from_unit(0.01 * s));
            density.push_back(std::exp(space.prior(k).log_density_unit(0.01 * s)));
        }
        out["prior_density"].push_back({{"x", x}, {"density", density}});
    }
    for (Index row = 0; row < n; ++row) {
        json draw = json::array();
        for (Index k = 0; k < d; ++k)
            draw.push_back(space.prior(k).from_unit(posterior.draws(row * posterior.draws.rows() / n, k)));
        out["draws"].push_back(std::move(draw));
    }
    return out;
}

json emulator_document(const Campaign& campaign, const Calibration& c) {
    const surrogate::CurveLeaveOneOut loo = c.trained->emulator.leave_one_out();
    json out{{"outputs", json::array()}, {"loo", json::array()}, {"rounds", json::array()}};
    for (const Index at : c.columns)
        out["outputs"].push_back(
            stage_label(campaign.store().header().outputs[static_cast<std::size_t>(at)]));
    for (Index m = 0; m < loo.z.cols(); ++m)
        for (Index g = 0; g < loo.z.rows(); ++g)
            out["loo"].push_back({{"output", m},
                                  {"predicted", loo.predicted(g, m)},
                                  {"actual", loo.actual(g, m)},
                                  {"z", loo.z(g, m)}});
    out["coverage90"] = loo.coverage.mean();
    out["rmse"] = values_of(loo.rmse);
    for (const CalibrationRound& round : c.rounds)
        out["rounds"].push_back({{"runs", round.runs},
                                 {"difference", round.check.difference},
                                 {"shift", round.check.shift},
                                 {"limit", round.check.limit},
                                 {"text", round.text}});
    return out;
}

/// Sobol indices along the first fitted curve, and that curve with each parameter low and high.
json sensitivity_document(const Campaign& campaign, const Calibration& c,
                          const std::vector<ParameterSummary>& all) {
    const ParameterSpace& space = campaign.space();
    const std::vector<CampaignCurve> curves = campaign.curves();
    const auto at = std::ranges::find_if(curves, [](const CampaignCurve& t) { return !t.test->held_out; });
    const Index first = fitted_place(c, at->first), n = at->count(), d = space.dimension();
    const auto curve = [&](const VectorXd& x) {
        const VectorXd mean = c.trained->emulator.predict_mean(x).segment(first, n);
        VectorXd out(n);
        for (Index m = 0; m < n; ++m) out[m] = transform_at(c, first + m).inverse(mean[m]);
        return out;
    };
    surrogate::SensitivityOptions options;
    options.seed = run_seed(campaign.settings().seed, 0, 14);
    options.samples = 1024;
    const surrogate::Sensitivity indices = surrogate::sobol_indices(
        [&](const VectorXd& x) { return VectorXd(c.trained->emulator.predict_mean(x).segment(first, n)); },
        space.priors, options);
    json out{{"names", json::array()}, {"test", at - curves.begin()}, {"first_order", json::array()},
             {"total", json::array()}, {"low", json::array()},        {"high", json::array()}};
    for (Index k = 0; k < d; ++k) {
        const ParameterSummary& p = all[space.fitted[static_cast<std::size_t>(k)]];
        out["names"].push_back(p.name);
        out["first_order"].push_back(values_of(indices.first.col(k)));
        out["total"].push_back(values_of(indices.total.col(k)));
        VectorXd x = c.fit.estimate;
        x[k] = space.prior(k).to_unit(p.prior_q05);
        out["low"].push_back(values_of(curve(x)));
        x[k] = space.prior(k).to_unit(p.prior_q95);
        out["high"].push_back(values_of(curve(x)));
    }
    return out;
}

std::string in_words(std::string name) {
    std::ranges::replace(name, '_', ' ');
    return name;
}

/// How closely direct runs follow the curves that were fitted, in words.
std::string followed(const json& tests) {
    std::string out;
    for (const json& test : tests) {
        if (test["held_out"].get<bool>()) continue;
        const std::string file = test["file"].get<std::string>();
        const double rmse = test["rmse"].get<double>();
        if (!out.empty()) out += ", ";
        if (test.contains("rmse_loading"))
            out += fmt::format("{} to {:.1e} m/m over the loading stages ({:.1e} over all readings)", file,
                               test["rmse_loading"].get<double>(), rmse);
        else
            out += fmt::format("the {} of {} to {}", in_words(test["channel"].get<std::string>()), file,
                               readable(rmse, test["unit"].get<std::string>()));
    }
    return out;
}

std::string verdict(const Calibration& c, const std::vector<ParameterSummary>& parameters,
                    const json& result) {
    std::string open;
    for (const ParameterSummary& p : parameters)
        if (!p.fixed && !p.identified) open += (open.empty() ? "" : ", ") + p.name;
    return fmt::format(
        "Direct DEM runs at the estimate follow {}; {}. What is left over: {}.", followed(result["tests"]),
        open.empty() ? "every parameter is identified" : "these data do not identify " + open,
        c.rounds.back().check.agrees() ? "see the residuals by reading below"
                                       : "emulator and direct runs still differ by more than is tolerable");
}

}  // namespace

json curves_document(const Campaign& campaign, const std::vector<RunRecord>& runs, const VectorXd& simulated,
                     const json& tests) {
    json out = tests;
    const std::vector<CampaignCurve> curves = campaign.curves();
    for (std::size_t t = 0; t < curves.size(); ++t) {
        const CampaignCurve& curve = curves[t];
        const CampaignTest& test = *curve.test;
        json phase = json::array(), replicates = json::array();
        for (const std::size_t reading : test.readings)
            phase.push_back(test.test->phase.empty() ? "loading" : test.test->phase[reading]);
        for (const RunRecord& run : runs)
            if (run.ok) replicates.push_back(values_of(run.outputs.segment(curve.first, curve.count())));
        out[t].update({{"x_name", test.kind->x_name},
                       {"x_unit", test.kind->x_unit},
                       {"x_log", test.kind->x_logarithmic},
                       {"y_unit", curve.channel->unit},
                       {"x", values_of(test.measured(test.kind->x_name))},
                       {"phase", phase},
                       {"measured", values_of(curve.measured())},
                       {"simulated", values_of(simulated.segment(curve.first, curve.count()))},
                       {"replicates", replicates}});
    }
    return out;
}

json packing_document(Campaign& campaign, const RunSpec& spec) {
    const CampaignTest& test = campaign.tests().front();
    const PictureOfTest picture =
        test.kind->picture(*campaign.specimen(test, spec), contact_law(campaign.settings(), spec.parameters),
                           campaign.settings(), campaign.grain_density(), *test.test);
    json x = json::array(), contacts = json::array();
    for (Index p = 0; p < picture.packing.radii.size(); ++p)
        x.push_back(values_of(picture.packing.centres.col(p)));
    for (const engine::ContactView& contact : picture.contacts)
        contacts.push_back({contact.i, contact.j, contact.normal_force});
    return {{"cell", values_of(picture.packing.cell.diagonal())},
            {"x", x},
            {"radius", values_of(picture.packing.radii)},
            {"contacts", contacts},
            {"stress", picture.stress},
            {"caption", fmt::format("{} particles of {} under {:.0f} kPa axial stress",
                                    picture.packing.radii.size(), test.test->file, picture.stress / 1000)}};
}

json quasi_static_document(const std::vector<RunRecord>& runs) {
    VectorXd worst = VectorXd::Zero(diagnostic_count);
    for (const RunRecord& run : runs)
        if (run.ok) worst = worst.cwiseMax(run.diagnostics);
    return {
        {"inertial_number", worst[inertial_number]},
        {"unbalanced_ratio", worst[unbalanced_ratio]},
        {"servo_error", worst[servo_error]},
        {"text",
         fmt::format("Largest values over {} direct runs; energy balance closed to {:.1e} of the energies "
                     "exchanged, largest overlap {:.1f} % of the radius sum.",
                     runs.size(), worst[energy_error], 100 * worst[overlap])}};
}

json calibration_document(Campaign& campaign, const lab_data::Sample& sample, const Calibration& c,
                          const std::vector<ParameterSummary>& parameters, const json& result) {
    json document = result;
    document["description"] = sample.description;
    document["verdict"] = verdict(c, parameters, result);
    document["parameters"] = parameters_document(parameters);
    document["tests"] = curves_document(campaign, c.confirmation, c.simulated, result["tests"]);
    add_bands(document["tests"], campaign, c);
    document["posterior"] = posterior_document(campaign, c);
    document["emulator"] = emulator_document(campaign, c);
    document["sensitivity"] = sensitivity_document(campaign, c, parameters);
    if (result["tests"].size() > 1) {
        document["identification"] = identification_document(campaign, c);
        document["trade_off"] = trade_off_document(campaign, c);
    }
    document["packing"] = packing_document(campaign, c.confirmation.front().spec);
    document["quasi_static"] = quasi_static_document(c.confirmation);
    document["settings"] = to_toml(campaign.settings());
    return document;
}

}  // namespace loam::experiments
