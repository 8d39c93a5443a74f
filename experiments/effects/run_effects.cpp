#include "experiments/effects/run_effects.hpp"

namespace loam::experiments {

TestEffects::TestEffects(const Settings& settings) {
    std::size_t first = engine::find_law(settings.law)->parameters.size();
    for (const std::string& name : settings.effects) {
        const ModelEffect* effect = find_model_effect(name);
        if (effect->is_mundane()) applied_.push_back({effect, first});
        first += effect->parameters.size();
    }
}

std::span<const double> TestEffects::values_of(const Applied& applied, const Eigen::VectorXd& parameters) {
    return std::span<const double>(parameters.data(), static_cast<std::size_t>(parameters.size()))
        .subspan(applied.first, applied.effect->parameters.size());
}

double TestEffects::void_ratio_error(const Eigen::VectorXd& parameters) const {
    double sum = 0;
    for (const Applied& a : applied_)
        if (a.effect->void_ratio_error) sum += a.effect->void_ratio_error(values_of(a, parameters));
    return sum;
}

lab_data::Test TestEffects::as_met(const SimulatedTest& test, const Eigen::VectorXd& parameters) const {
    for (const Applied& a : applied_)
        if (a.effect->as_met) return a.effect->as_met(test, values_of(a, parameters));
    return test.test;
}

void TestEffects::correct(const SimulatedTest& test, const Eigen::VectorXd& parameters,
                          Eigen::VectorXd& outputs) const {
    for (const Applied& a : applied_)
        if (a.effect->correct) a.effect->correct(test, values_of(a, parameters), outputs);
}

}  // namespace loam::experiments
