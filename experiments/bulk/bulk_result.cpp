#include "experiments/bulk/bulk_result.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "experiments/workflows/result_json.hpp"

namespace loam::experiments {
namespace {

using nlohmann::json;

json sample_result(const SampleOutcome& s, const std::string& name, const ParameterSpace& space) {
    json out{{"sample", name}, {"status", s.status}, {"rmse", nullptr}, {"me", nullptr}};
    if (s.followed) out["followed"] = *s.followed;
    if (!s.reason.empty()) out["reason"] = s.reason;
    if (s.fit) {
        out["parameters"] = parameters_result(summarise(space, s.fit->estimate, s.fit->quantiles));
        out["misfit_sd"] = s.fit->misfit;
        out["effective_draws"] = s.fit->effective;
        out["emulator_share"] = s.fit->emulator_share;
    }
    if (!s.direct) return out;
    out["direct_runs"] = s.direct->curves.size();
    if (s.direct->curves.empty()) return out;
    out["rmse"] = s.rmse;
    out["me"] = s.mean_error;
    if (s.direct->sd.size() > 0)
        out["packing_sd"] = std::sqrt(s.direct->sd.squaredNorm() / static_cast<double>(s.direct->sd.size()));
    return out;
}

/// A cell of a CSV file, quoted where it must be.
std::string cell(const std::string& text) {
    if (text.find_first_of(",\"\n\r") == std::string::npos) return text;
    std::string out = "\"";
    for (const char c : text) out += c == '"' ? std::string("\"\"") : std::string(1, c);
    return out + '"';
}

std::string cell(const lab_data::Covariate& covariate) {
    if (const auto* number = std::get_if<double>(&covariate)) return fmt::format("{}", *number);
    if (const auto* label = std::get_if<std::string>(&covariate)) return cell(*label);
    return {};
}

std::string parameter_cells(const SampleOutcome& s, const ParameterSpace& space) {
    std::string out;
    if (!s.fit) {
        for (std::size_t k = 0; k < space.parameters.size(); ++k) out += ",,,,";
        return out;
    }
    for (const ParameterSummary& p : summarise(space, s.fit->estimate, s.fit->quantiles))
        out += fmt::format(",{},{},{},{}", p.estimate, p.q05, p.q95, p.identified ? 1 : 0);
    return out;
}

}  // namespace

void add_study(json& result, const BulkStudy& study, const lab_data::DataSet& set,
               const ParameterSpace& space) {
    result["samples"] = json::array();
    std::size_t calibrated = 0, not_followed = 0;
    for (const SampleOutcome& s : study.samples) {
        result["samples"].push_back(sample_result(s, set.rows[s.row].name, space));
        calibrated += s.status == "calibrated" ? 1 : 0;
        not_followed += s.followed == false ? 1 : 0;
    }
    const PooledError& e = study.overall;
    const bool any = e.readings > 0;
    result["overall"] = {{"rmse", any ? json(e.rmse) : json()},
                         {"me", any ? json(e.mean_error) : json()},
                         {"pearson_r", any ? json(e.pearson_r) : json()},
                         {"readings", e.readings},
                         {"calibrated", calibrated},
                         {"not_followed", not_followed},
                         {"mended", study.mended},
                         {"failed", study.samples.size() - calibrated}};
    if (study.comparison) {
        const auto errors = [](const PooledError& p) {
            return json{{"rmse", p.rmse}, {"me", p.mean_error}, {"pearson_r", p.pearson_r}};
        };
        result["methods"] = {{"samples", study.comparison->samples},
                             {"curves", "the emulators' at the estimates of each method"},
                             {"emulator", errors(study.comparison->emulator)},
                             {"inverse-kriging", errors(study.comparison->inverse_kriging)}};
    }
    for (const Part& part : study.parts) result["parts"][part.name] = part.seconds;
}

std::string parameters_csv(const BulkStudy& study, const lab_data::DataSet& set,
                           const ParameterSpace& space) {
    std::string out = "sample,status,rmse,me";
    for (const engine::ParameterInfo& p : space.parameters) {
        const std::string unit = p.unit.empty() || p.unit == "1" ? "" : fmt::format("_{}", p.unit);
        out += fmt::format(",{0}{1},{0}_q05{1},{0}_q95{1},{0}_identified", p.name, unit);
    }
    for (const std::string& name : set.covariates) out += ',' + cell(name);
    out += '\n';
    for (const SampleOutcome& s : study.samples) {
        out += cell(set.rows[s.row].name) + ',' + s.status;
        out += s.direct && !s.direct->curves.empty() ? fmt::format(",{},{}", s.rmse, s.mean_error) : ",,";
        out += parameter_cells(s, space);
        for (const lab_data::Covariate& covariate : set.rows[s.row].covariates) out += ',' + cell(covariate);
        out += '\n';
    }
    return out;
}

}  // namespace loam::experiments
