#include "experiments/bulk/bulk_report.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <stdexcept>

#include "experiments/output/json_values.hpp"
#include "experiments/quantile.hpp"
#include "experiments/settings/writing.hpp"

namespace loam::experiments {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;
using nlohmann::json;

json samples_document(const json& result, const BulkStudy& study) {
    json out = json::array();
    for (std::size_t k = 0; k < study.samples.size(); ++k) {
        const SampleOutcome& s = study.samples[k];
        json entry = result["samples"][k];
        if (s.sample) {
            entry["stress"] = values_of(s.sample->curve.stress);
            entry["measured"] = values_of(s.sample->curve.strain);
        }
        if (s.fit) entry["predicted"] = values_of(s.fit->predicted);
        if (s.direct && !s.direct->curves.empty()) {
            entry["simulated"] = values_of(s.direct->mean);
            entry["replicates"] = json::array();
            for (const VectorXd& curve : s.direct->curves) entry["replicates"].push_back(values_of(curve));
        }
        out.push_back(std::move(entry));
    }
    return out;
}

/// Least, quartiles and largest value; nothing for no values.
json five_numbers(std::vector<double> values) {
    if (values.empty()) return nullptr;
    return {quantile(values, 0), quantile(values, 0.25), quantile(values, 0.5), quantile(values, 0.75),
            quantile(values, 1)};
}

/// How far the ensemble reaches beside the measurements, at each stage (Fig. 3 of De Pue et al. 2019).
json coverage_document(const BulkStudy& study, const StageSet& stages) {
    json out = json::array();
    for (std::size_t k = 0; k < stages.stress.size(); ++k) {
        std::vector<double> simulated, measured;
        for (const RunRecord& run : study.training)
            if (run.ok && run.outputs[run.outputs.size() - 1] > static_cast<double>(k))
                simulated.push_back(run.outputs[static_cast<Index>(k)]);
        for (const SampleOutcome& s : study.samples) {
            if (!s.sample) continue;
            const VectorXd& stress = s.sample->curve.stress;
            // A sample counts at the stage nearest to its own ones.
            for (Index r = 0; r < stress.size(); ++r) {
                const auto nearest = std::ranges::min_element(
                    stages.stress, {}, [&](double stage) { return std::abs(std::log(stage / stress[r])); });
                if (nearest - stages.stress.begin() == static_cast<std::ptrdiff_t>(k))
                    measured.push_back(s.sample->curve.strain[r]);
            }
        }
        out.push_back({{"stress", stages.stress[k]},
                       {"simulated", five_numbers(std::move(simulated))},
                       {"measured", five_numbers(std::move(measured))}});
    }
    return out;
}

json matrix_document(const MatrixXd& m) {
    json out = json::array();
    for (Index r = 0; r < m.rows(); ++r) out.push_back(values_of(m.row(r).transpose()));
    return out;
}

json statistics_document(const GroupStatistics& s) {
    json out{{"quantities", json::array()}, {"groupings", json::array()}};
    for (const Quantity& q : s.quantities)
        out["quantities"].push_back({{"name", q.name},
                                     {"unit", q.unit},
                                     {"log", q.logarithmic},
                                     {"result", q.is_result},
                                     {"values", q.is_result ? values_of(q.values) : json::array()}});
    for (const Grouping& g : s.groupings) {
        json entry{{"covariate", g.covariate}, {"paired", g.paired},   {"kruskal_p", g.kruskal_p},
                   {"medians", g.medians},     {"letters", g.letters}, {"groups", json::array()}};
        for (const Group& group : g.groups)
            entry["groups"].push_back({{"label", group.label}, {"members", group.members}});
        out["groupings"].push_back(std::move(entry));
    }
    out["correlation"] = matrix_document(s.correlation);
    out["significance"] = matrix_document(s.significance);
    return out;
}

/// Of the sample with the most stages (Fig. 4); empty where too few runs of the ensemble reached them.
json semivariogram_document(const BulkStudy& study, const SharedEnsemble& ensemble) {
    const BulkSample* richest = nullptr;
    for (const SampleOutcome& s : study.samples)
        if (s.sample && (!richest || s.sample->curve.stress.size() > richest->curve.stress.size()))
            richest = &*s.sample;
    json out = json::array();
    if (!richest) return out;
    std::vector<std::vector<StageSemivariogram>> all;
    try {
        all = InverseKriging(ensemble, study.training).semivariograms(*richest);
    } catch (const std::runtime_error&) {
        return out;  // the study stands without them
    }
    for (std::size_t p = 0; p < all.size(); ++p) {
        json stages = json::array();
        for (const StageSemivariogram& s : all[p])
            stages.push_back({{"stress", s.stress},
                              {"distance", values_of(s.experimental.distance)},
                              {"value", values_of(s.experimental.value)},
                              {"nugget", s.model.nugget},
                              {"sill", s.model.sill},
                              {"range", s.model.range}});
        out.push_back({{"parameter", ensemble.space().info(static_cast<Index>(p)).name}, {"stages", stages}});
    }
    return out;
}

std::string verdict(const json& result) {
    const json& o = result["overall"];
    std::string text =
        fmt::format("{} of {} samples are calibrated", o["calibrated"].get<int>(), result["samples"].size());
    if (o["readings"].get<int>() == 0) return text + "; no direct runs were asked for.";
    return text +
           fmt::format(
               "; direct DEM runs at the estimates, on packings that no emulator was trained on, follow "
               "the measurements to {:.2e} m/m (mean error {:.1e} m/m, r = {:.4f}).",
               o["rmse"].get<double>(), o["me"].get<double>(), o["pearson_r"].get<double>());
}

}  // namespace

json bulk_document(const json& result, const BulkStudy& study, const GroupStatistics& statistics,
                   const lab_data::DataSet& set, const SharedEnsemble& ensemble, const Settings& settings) {
    json out = result;
    out.erase("samples");
    out.erase("overall");
    out["description"] = set.description.empty() ? set.source : set.description;
    if (!set.attribution.empty())
        out["description"] = out["description"].get<std::string>() + " " + set.attribution;
    out["verdict"] = verdict(result);
    out["settings"] = to_toml(settings);
    out["bulk"] = {{"overall", result["overall"]},
                   {"method", settings.method},
                   {"parts", result["parts"]},
                   {"methods", result.value("methods", json())},
                   {"emulators", study.emulators},
                   {"samples", samples_document(result, study)},
                   {"coverage", coverage_document(study, ensemble.stages())},
                   {"statistics", statistics_document(statistics)},
                   {"semivariograms", semivariogram_document(study, ensemble)}};
    return out;
}

}  // namespace loam::experiments
