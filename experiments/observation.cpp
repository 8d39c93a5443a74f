#include "experiments/observation.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <stdexcept>
#include <string>

namespace loam::experiments {
namespace {

using Eigen::Index;
using Eigen::VectorXd;

/// What a channel's numbers are given over.
enum class Unit { si, cell_pressure, normal_stress, box_height };

double value_of(Unit unit, const lab_data::Test& test) {
    switch (unit) {
        case Unit::cell_pressure:
            return test.cell_pressure;
        case Unit::normal_stress:
            return test.normal_stress;
        case Unit::box_height:
            return test.box_height;
        case Unit::si:
            break;
    }
    return 1;
}

/// Of the size of the misfit, in usual ones, that the channels of a triaxial or a direct shear test share: a
/// model that cannot follow strength and volume both would else follow one of them to the last reading, call
/// all of the other's misfit its own, and which one would be chance. So both give way, each by its usual
/// size, and none less than what sound codes differ by.
const surrogate::Prior shared_misfit{surrogate::PriorKind::lognormal, 0, 0.5, 0.03, 30};

/// What is assumed of a channel's noise; numbers are over its unit.
struct ChannelModel {
    lab_data::TestKind kind;
    std::string_view channel;
    Unit unit;
    std::optional<OutputTransform> transform;  // its scale in the unit
    double relative, floor;
    double tolerable_difference;
    double usual_misfit;  // that the size is a multiple of
    double least_misfit;
    surrogate::Prior misfit;
};

const ChannelModel channel_models[] = {
    // The resolution: De Pue et al. 2019 read strain to 5e-5. Misfit: a few 1e-4 where the model follows
    // well, up to several percent where it does not.
    {lab_data::TestKind::oedometer,
     "axial_strain",
     Unit::si,
     std::nullopt,
     0.01,
     5e-5,
     2.5e-3,
     1,
     0,
     {surrogate::PriorKind::lognormal, -3.5, 0.5, 2e-5, 0.05}},
    // ln(1 + q/p) is the logarithm of the stress ratio. Misfit: some percent of the cell pressure.
    {lab_data::TestKind::triaxial, "deviatoric_stress", Unit::cell_pressure, OutputTransform{1, false}, 0.01,
     5e-3, 0.05, 0.05, stress_between_codes, shared_misfit},
    // Changes its sign. Burettes read it to some 1e-4.
    {lab_data::TestKind::triaxial, "volumetric_strain", Unit::si, OutputTransform{0.01, true}, 0.01, 2e-4,
     2.5e-3, 0.003, volume_between_codes, shared_misfit},
    {lab_data::TestKind::direct_shear, "shear_stress", Unit::normal_stress, OutputTransform{1, false}, 0.01,
     5e-3, 0.025, 0.03, stress_between_codes, shared_misfit},
    // As the volumetric strain of a triaxial test.
    {lab_data::TestKind::direct_shear, "settlement", Unit::box_height, OutputTransform{0.01, true}, 0.01,
     2e-4, 2.5e-3, 0.003, volume_between_codes, shared_misfit},
};

const ChannelModel& model_of(lab_data::TestKind kind, std::string_view channel) {
    for (const ChannelModel& model : channel_models)
        if (model.kind == kind && model.channel == channel) return model;
    throw std::logic_error("no model of the noise of channel " + std::string(channel));
}

std::vector<Index> phases_of(const CampaignTest& test) {
    std::vector<Index> first{0};
    const std::vector<std::string>& phase = test.test->phase;
    for (std::size_t k = 1; k < test.readings.size() && !phase.empty(); ++k)
        if (phase[test.readings[k]] != phase[test.readings[k - 1]]) first.push_back(static_cast<Index>(k));
    return first;
}

/// Adds one channel of a test. `used` are the kinds of test met so far, in the order of the misfits.
void append_curve(const CampaignTest& test, std::size_t channel, int specimen,
                  std::vector<lab_data::TestKind>& used, Observation& out) {
    const std::string name(test.kind->channels[channel].name);
    const ChannelModel& model = model_of(test.test->kind, name);
    auto met = std::ranges::find(used, model.kind);
    if (met == used.end()) {
        out.misfit_priors.push_back(model.misfit);
        met = used.insert(used.end(), model.kind);
    }
    ObservedCurve curve;
    curve.first = out.measured.size();
    curve.count = static_cast<Index>(test.readings.size());
    curve.test = specimen;
    curve.unit = value_of(model.unit, *test.test);
    curve.transform = model.transform;
    if (curve.transform) curve.transform->scale *= curve.unit;
    curve.relative = model.relative;
    curve.floor = model.floor;
    curve.tolerable_difference = model.tolerable_difference;
    curve.misfit = met - used.begin();
    curve.usual_misfit = model.usual_misfit;
    curve.least_misfit = model.least_misfit;
    if (model.kind == lab_data::TestKind::oedometer)
        curve.phases = phases_of(test);
    else
        curve.along = places_along(test.measured(test.kind->x_name));
    out.curves.push_back(curve);

    const auto stated = test.test->measurement_sd.find(name);
    const double sd =
        stated == test.test->measurement_sd.end() ? std::numeric_limits<double>::quiet_NaN() : stated->second;
    out.measured.conservativeResize(curve.first + curve.count);
    out.measured.tail(curve.count) = test.measured(name);
    out.sd->conservativeResize(curve.first + curve.count);
    out.sd->tail(curve.count).setConstant(sd);
}

OutputTransform transform_up_to(double largest) {
    OutputTransform transform;
    while (16 * transform.scale <= largest) transform.scale *= 4;
    return transform;
}

}  // namespace

double OutputTransform::forward(double y) const {
    return linear ? y / scale : std::log1p(std::max(y / scale, -0.9));
}
double OutputTransform::inverse(double t) const {
    return linear ? scale * t : scale * std::expm1(t);
}
double OutputTransform::derivative(double y) const {
    return linear ? 1 / scale : 1 / (scale + std::max(y, -0.9 * scale));
}

VectorXd places_along(const VectorXd& strain) {
    VectorXd path(strain.size());
    double gone = 0, before = 0;
    for (Index k = 0; k < strain.size(); ++k) {
        gone += std::abs(strain[k] - before);
        path[k] = gone;
        before = strain[k];
    }
    return (path / std::max(gone, std::numeric_limits<double>::min())).cwiseSqrt();
}

OutputTransform transform_for(const Observation& observation) {
    return transform_up_to(observation.measured.maxCoeff());
}

std::vector<ObservedCurve> curves_of(const Observation& observation) {
    if (!observation.curves.empty()) return observation.curves;
    ObservedCurve all;
    all.count = observation.measured.size();
    all.relative = observation.relative;
    all.floor = observation.floor;
    return {all};
}

std::vector<surrogate::Prior> misfit_priors_of(const Observation& observation) {
    if (!observation.misfit_priors.empty()) return observation.misfit_priors;
    return {strain_misfit_prior()};
}

const surrogate::Prior& strain_misfit_prior() {
    return model_of(lab_data::TestKind::oedometer, "axial_strain").misfit;
}

std::vector<OutputTransform> transforms_of(const Observation& observation) {
    std::vector<OutputTransform> out;
    for (const ObservedCurve& curve : curves_of(observation))
        out.insert(out.end(), static_cast<std::size_t>(curve.count),
                   curve.transform.value_or(
                       transform_up_to(observation.measured.segment(curve.first, curve.count).maxCoeff())));
    return out;
}

Observation observation_of(const Campaign& campaign, std::vector<Index>& columns,
                           std::span<const lab_data::TestKind> kinds) {
    const Settings& settings = campaign.settings();
    Observation out;
    out.sd.emplace();
    std::vector<lab_data::TestKind> used;
    columns.clear();
    for (std::size_t t = 0; t < campaign.tests().size(); ++t) {
        const CampaignTest& test = campaign.tests()[t];
        const bool other = !kinds.empty() && std::ranges::find(kinds, test.test->kind) == kinds.end();
        if (test.held_out || other) continue;
        for (Index k = 0; k < test.outputs(); ++k) columns.push_back(test.first + k);
        for (std::size_t c = 0; c < test.kind->channels.size(); ++c)
            append_curve(test, c, static_cast<int>(t), used, out);
    }
    // A real specimen averages over countless grains; a synthetic one scatters like the packing that it is.
    const int grains = settings.calibration.specimen_particles;
    out.packing_share = grains > 0            ? static_cast<double>(settings.particles) / grains
                        : campaign.measured() ? 0.0
                                              : 1.0;
    return out;
}

}  // namespace loam::experiments
