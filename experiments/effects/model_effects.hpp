// The effects that a model may have beside its base law: those of the contact (engine/contact/registry.hpp),
// freed rotation, and those of the laboratory test, which the engine knows nothing of. The command line, the
// configuration reader, the generated reference and the diagnosis read this one table. To add an effect of
// the test: its free function in test_models.hpp and one line of the table in model_effects.cpp.
#pragma once

#include <span>
#include <string_view>
#include <vector>

#include "engine/contact/registry.hpp"
#include "experiments/lab_tests/registry.hpp"
#include "lab_data/sample.hpp"

namespace loam::experiments {

/// What an effect belongs to. Errors of apparatus and specimen are thought of before the physics of grains.
enum class EffectOrigin { contact, rotation, apparatus, specimen };

/// A measured test and those of its readings that are simulated.
struct SimulatedTest {
    const LabTestKind& kind;
    const lab_data::Test& test;
    const std::vector<std::size_t>& readings;

    /// A column of the measurement at the readings [n], SI.
    Eigen::VectorXd column(std::string_view name) const;
};

struct ModelEffect {
    std::string_view name;
    std::string_view meaning;
    std::string_view source;
    std::span<const engine::ParameterInfo>
        parameters;  // the first is the strength, 0 for none; none: it is there or not
    EffectOrigin origin;
    const engine::EffectInfo* contact = nullptr;  // of the engine
    /// Whether it can show in a test of that kind; null: in every one.
    bool (*touches)(lab_data::TestKind) = nullptr;
    /// What the specimen's initial void ratio is above the stated one, with these values (SI); null: nothing.
    double (*void_ratio_error)(std::span<const double> values) = nullptr;
    /// The test as its specimen meets it; null: as measured. It has the readings used and no others.
    lab_data::Test (*as_met)(const SimulatedTest& test, std::span<const double> values) = nullptr;
    /// Makes a specimen's outputs [channels x n] those of the device; null: they are.
    void (*correct)(const SimulatedTest& test, std::span<const double> values,
                    Eigen::VectorXd& outputs) = nullptr;

    bool is_mundane() const { return origin == EffectOrigin::apparatus || origin == EffectOrigin::specimen; }
    bool goes_with(std::string_view law) const { return contact == nullptr || contact->goes_with(law); }
    bool needs_fragile() const { return contact != nullptr && contact->needs_fragile; }
    bool needs_rotation() const { return contact != nullptr && contact->needs_rotation; }
};

/// All effects, those of the contact first, in a fixed order.
std::span<const ModelEffect> model_effects();

/// The effect of that name, or nullptr.
const ModelEffect* find_model_effect(std::string_view name);

}  // namespace loam::experiments
