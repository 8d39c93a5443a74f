#include "experiments/density.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>

#include "engine/packing.hpp"

namespace loam::experiments {
namespace {

std::optional<double> property(const lab_data::Sample& sample, const std::string& name) {
    const auto found = sample.properties.find(name);
    if (found == sample.properties.end()) return std::nullopt;
    const double* value = std::get_if<double>(&found->second);
    return value ? std::optional(*value) : std::nullopt;
}

}  // namespace

LimitVoidRatios limits_of_spheres(double spread) {
    struct Row {
        double spread, least, greatest;
    };
    constexpr std::array rows{Row{0, 0.584, 1.19}, Row{0.3, 0.564, 1.039}, Row{0.6, 0.538, 1.024}};
    const std::size_t k = spread < 0.3 ? 0 : 1;
    const double share = std::min(1.0, (spread - rows[k].spread) / (rows[k + 1].spread - rows[k].spread));
    return {std::lerp(rows[k].least, rows[k + 1].least, share),
            std::lerp(rows[k].greatest, rows[k + 1].greatest, share)};
}

double median_grain_size(const lab_data::Sample& sample) {
    const auto& grading = sample.grading;
    if (grading.size() < 2 || grading.front().passing > 0.5 || grading.back().passing < 0.5) return 0;
    std::size_t k = 1;
    while (grading[k].passing < 0.5) ++k;
    const double share =
        (0.5 - grading[k - 1].passing) / std::max(1e-12, grading[k].passing - grading[k - 1].passing);
    const double first = std::max(grading[k - 1].sieve, 1e-7);
    return first * std::pow(grading[k].sieve / first, share);
}

std::optional<double> spread_of_grading(const lab_data::Sample& sample) {
    constexpr double end = 0.005, widest = 0.5, narrowest = 0.01;
    double least = 0, greatest = 0;
    for (const lab_data::GradingPoint& point : sample.grading) {
        if (point.passing <= end) least = point.sieve;
        if (point.passing >= 1 - end && greatest == 0) greatest = point.sieve;
    }
    if (!(least > 0 && greatest > least)) return std::nullopt;
    const double spread = (greatest - least) / (greatest + least);
    return spread <= widest ? std::optional(std::max(narrowest, spread)) : std::nullopt;
}

LimitVoidRatios limits_of_soil(const lab_data::Sample& sample) {
    const std::string file = (sample.folder / "sample.toml").string();
    LimitVoidRatios limits;
    const auto least = property(sample, "minimum_void_ratio"),
               greatest = property(sample, "maximum_void_ratio");
    if (least && greatest) {
        limits = {*least, *greatest};
    } else if (const double d50_mm = 1000 * median_grain_size(sample); d50_mm > 0) {
        const double range = 0.23 + 0.06 / d50_mm;
        limits.least = (range - 0.072) / 0.53;
        limits.greatest = limits.least + range;
    } else {
        throw lab_data::UserError({.file = file,
                                   .column = "minimum_void_ratio, maximum_void_ratio",
                                   .constraint = "are needed to match the relative density",
                                   .remedy = "state both under [soil.properties], or a grading, or use "
                                             "specimen.match = \"void_ratio\""});
    }
    if (!(limits.least > 0 && limits.greatest > limits.least))
        throw lab_data::UserError(
            {.file = file,
             .column = "minimum_void_ratio",
             .value = fmt::format("{}", limits.least),
             .constraint = fmt::format("must be above 0 and below the maximum, {}", limits.greatest),
             .remedy = "correct the limit void ratios"});
    return limits;
}

double strain_before_shearing(const lab_data::Sample& sample, const lab_data::Test& test) {
    constexpr double alike = 0.15, largest = 0.05;
    if (test.kind != lab_data::TestKind::direct_shear || !test.initial_void_ratio) return 0;
    const auto apart = [&](const lab_data::Test& other) {
        return std::abs(other.initial_void_ratio.value_or(INFINITY) - *test.initial_void_ratio);
    };
    const lab_data::Test* nearest = nullptr;
    for (const lab_data::Test& other : sample.tests)
        if (other.kind == lab_data::TestKind::oedometer && other.columns.contains("axial_strain") &&
            other.size() > 0 && apart(other) <= alike && (!nearest || apart(other) < apart(*nearest)))
            nearest = &other;
    if (!nearest) return 0;
    const std::vector<double>&stress = nearest->column("axial_stress"),
          &strain = nearest->column("axial_strain");
    double below = lab_data::seating_stress(*nearest), before = 0;
    for (std::size_t k = 0; k < nearest->size() && below < test.normal_stress; ++k) {
        if (stress[k] <= below) continue;
        const double share = std::min(1.0, (test.normal_stress - below) / (stress[k] - below));
        before = std::lerp(before, strain[k], share);
        below = stress[k];
    }
    return before > 0 && before <= largest ? before : 0;
}

double target_porosity(const Settings& settings, const lab_data::Sample& sample, const lab_data::Test& test) {
    if (settings.specimen.porosity) return *settings.specimen.porosity;
    if (!test.initial_void_ratio) return engine::PackingOptions{}.target_porosity;
    double void_ratio = *test.initial_void_ratio;
    if (settings.specimen.match == "relative_density") {
        const LimitVoidRatios soil = limits_of_soil(sample),
                              spheres = limits_of_spheres(settings.specimen.size_spread);
        const double looseness = (void_ratio - soil.least) / (soil.greatest - soil.least);
        void_ratio = std::lerp(spheres.least, spheres.greatest, looseness);
    }
    void_ratio = (1 + void_ratio) / (1 - strain_before_shearing(sample, test)) - 1;
    return void_ratio / (1 + void_ratio);
}

}  // namespace loam::experiments
