#include "experiments/effects/model_effects.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <string>

#include "experiments/effects/test_models.hpp"

namespace loam::experiments {
namespace {

using Eigen::Index;
using Eigen::VectorXd;
using engine::ParameterInfo;
using engine::PriorKind;
using lab_data::TestKind;

constexpr double fitted = std::numeric_limits<double>::quiet_NaN();

/// The load that moves the device [n] (Pa): beyond seating in an oedometer, else what the specimen bears.
VectorXd load_of(const SimulatedTest& test, const VectorXd& outputs) {
    if (test.test.kind == TestKind::oedometer)
        return test.column("axial_stress").array() - lab_data::seating_stress(test.test);
    return outputs.head(static_cast<Index>(test.readings.size()));  // the stress is the first channel
}

/// Adds a strain [n] of the device to what is read as the specimen's.
void add_strain(const SimulatedTest& test, const VectorXd& strain, VectorXd& outputs) {
    if (test.test.kind == TestKind::oedometer) {
        outputs += strain;
        return;
    }
    const double length = test.test.kind == TestKind::direct_shear ? test.test.box_length : 1.0;
    const VectorXd x = test.column(test.kind.x_name);
    const Index n = x.size();
    for (Index first = 0; first < outputs.size(); first += n)
        outputs.segment(first, n) = at_shifted_readings(x, length * strain, outputs.segment(first, n));
}

void add_compliance(const SimulatedTest& test, std::span<const double> v, VectorXd& outputs) {
    if (v[0] != 0) add_strain(test, device_strain(load_of(test, outputs), v[0]), outputs);
}

void add_seating(const SimulatedTest& test, std::span<const double> v, VectorXd& outputs) {
    if (v[0] != 0) add_strain(test, bedding_strain(load_of(test, outputs), v[0], v[1]), outputs);
}

bool has_walls(TestKind kind) {
    return kind != TestKind::triaxial;
}

lab_data::Test with_ring_friction(const SimulatedTest& test, double beta) {
    lab_data::Test out = test.test;
    const double seat = lab_data::seating_stress(test.test);
    out.seating_stress = seat;  // whatever the first reading is
    const VectorXd met = mean_ring_stress(test.column("axial_stress"), beta, seat);
    out.columns.clear();
    out.lines.clear();
    out.phase.clear();
    for (std::size_t k = 0; k < test.readings.size(); ++k) {
        // A stage at the seating stress would not count as one.
        out.columns["axial_stress"].push_back(std::max(met[static_cast<Index>(k)], 1.001 * seat));
        out.columns["axial_strain"].push_back(test.test.column("axial_strain")[test.readings[k]]);
        out.lines.push_back(test.test.lines[test.readings[k]]);
        if (!test.test.phase.empty()) out.phase.push_back(test.test.phase[test.readings[k]]);
    }
    return out;
}

lab_data::Test with_wall_friction(const SimulatedTest& test, std::span<const double> v) {
    if (test.test.kind == TestKind::oedometer && v[0] != 0)
        return with_ring_friction(test, 4 * v[2] * v[0] * v[1]);
    lab_data::Test out = test.test;
    if (test.test.kind == TestKind::direct_shear && v[0] != 0) out.wall_friction_angle = std::atan(v[0]);
    return out;
}

double void_ratio_error(std::span<const double> v) {
    return v[0];
}

constexpr std::array wall_friction_parameters{
    ParameterInfo{"wall_friction",
                  "tan delta",
                  "1",
                  0.0,
                  1.0,
                  {PriorKind::uniform, 0, 0, 0.0, 0.5},
                  "friction between the specimen and the ring or the box",
                  "Janssen 1895",
                  fitted},
    ParameterInfo{"ring_slenderness",
                  "H/D",
                  "1",
                  0.05,
                  2.0,
                  {PriorKind::uniform, 0, 0, 0.1, 0.5},
                  "height over diameter of the ring",
                  "ISO 17892-5: at most 1/2.5",
                  0.3},
    ParameterInfo{"ring_stress_ratio",
                  "K",
                  "1",
                  0.1,
                  1.0,
                  {PriorKind::uniform, 0, 0, 0.3, 0.7},
                  "lateral over axial stress at the ring",
                  "Jaky 1944, 1 - sin(phi)",
                  0.45},
};

constexpr std::array compliance_parameters{
    ParameterInfo{"apparatus_compliance",
                  "C",
                  "1/Pa",
                  0.0,
                  1e-6,
                  {PriorKind::uniform, 0, 0, 0.0, 3e-8},
                  "strain that the device adds for each unit of stress",
                  "ISO 17892-5, calibration of the device",
                  fitted},
};

constexpr std::array seating_parameters{
    ParameterInfo{"bedding_strain",
                  "a",
                  "1",
                  0.0,
                  0.2,
                  {PriorKind::uniform, 0, 0, 0.0, 0.02},
                  "strain that bedding adds in the end",
                  "Jardine, Symes and Burland 1984",
                  fitted},
    ParameterInfo{"bedding_stress",
                  "sigma_s",
                  "Pa",
                  1e2,
                  1e7,
                  {PriorKind::loguniform, 0, 0, 2e3, 2e5},
                  "stress over which it comes about",
                  "Jardine, Symes and Burland 1984",
                  3e4},
};

constexpr std::array density_parameters{
    ParameterInfo{"void_ratio_error",
                  "Delta e",
                  "1",
                  -0.3,
                  0.3,
                  {PriorKind::normal, 0.0, 0.03, -0.12, 0.12},
                  "initial void ratio above the stated one",
                  "ASTM D7263, determination of density",
                  fitted},
};

constexpr std::array of_the_model{
    ModelEffect{"rotation",
                "the particles' rotations, which a base may block, are free",
                "Cundall and Strack 1979",
                {},
                EffectOrigin::rotation},
    ModelEffect{.name = "wall_friction",
                .meaning = "friction on the ring of an oedometer or the box of a direct shear test",
                .source = "Janssen 1895; ISO 17892-5",
                .parameters = wall_friction_parameters,
                .origin = EffectOrigin::apparatus,
                .touches = has_walls,
                .as_met = with_wall_friction},
    ModelEffect{.name = "apparatus_compliance",
                .meaning = "the device's own deformation, proportional to the load, is read as strain",
                .source = "ISO 17892-5",
                .parameters = compliance_parameters,
                .origin = EffectOrigin::apparatus,
                .correct = add_compliance},
    ModelEffect{.name = "seating",
                .meaning = "bedding at the ends of the specimen is read as strain in the first stages",
                .source = "Jardine, Symes and Burland 1984",
                .parameters = seating_parameters,
                .origin = EffectOrigin::apparatus,
                .correct = add_seating},
    ModelEffect{.name = "density_error",
                .meaning = "the initial void ratio is off by an unknown amount, the same in every test",
                .source = "ASTM D7263",
                .parameters = density_parameters,
                .origin = EffectOrigin::specimen,
                .void_ratio_error = void_ratio_error},
};

std::vector<ModelEffect> made_table() {
    std::vector<ModelEffect> out;
    for (const engine::EffectInfo& effect : engine::effects())
        out.push_back({.name = effect.name,
                       .meaning = effect.meaning,
                       .source = effect.source,
                       .parameters = effect.parameters,
                       .origin = EffectOrigin::contact,
                       .contact = &effect});
    out.insert(out.end(), of_the_model.begin(), of_the_model.end());
    return out;
}

}  // namespace

VectorXd SimulatedTest::column(std::string_view name) const {
    const std::vector<double>& all = test.column(std::string(name));
    VectorXd out(static_cast<Index>(readings.size()));
    for (Index k = 0; k < out.size(); ++k) out[k] = all[readings[static_cast<std::size_t>(k)]];
    return out;
}

std::span<const ModelEffect> model_effects() {
    static const std::vector<ModelEffect> table = made_table();
    return table;
}

const ModelEffect* find_model_effect(std::string_view name) {
    const auto table = model_effects();
    const auto at = std::ranges::find(table, name, &ModelEffect::name);
    return at == table.end() ? nullptr : &*at;
}

}  // namespace loam::experiments
