#include "experiments/parameter_space.hpp"

#include <span>
#include <stdexcept>

#include "experiments/effects/model_effects.hpp"
#include "experiments/settings/parameters.hpp"

namespace loam::experiments {
namespace {

surrogate::PriorKind to_surrogate(engine::PriorKind kind) {
    switch (kind) {
        case engine::PriorKind::normal:
            return surrogate::PriorKind::normal;
        case engine::PriorKind::lognormal:
            return surrogate::PriorKind::lognormal;
        case engine::PriorKind::uniform:
            return surrogate::PriorKind::uniform;
        case engine::PriorKind::loguniform:
            return surrogate::PriorKind::loguniform;
    }
    throw std::invalid_argument("unknown kind of prior");
}

}  // namespace

bool ParameterSpace::is_logarithmic(Eigen::Index k) const {
    const surrogate::PriorKind kind = prior(k).kind;
    return kind == surrogate::PriorKind::lognormal || kind == surrogate::PriorKind::loguniform;
}

Eigen::VectorXd ParameterSpace::physical(const Eigen::VectorXd& x) const {
    Eigen::VectorXd out = values;
    for (Eigen::Index k = 0; k < dimension(); ++k)
        out[static_cast<Eigen::Index>(fitted[static_cast<std::size_t>(k)])] = prior(k).from_unit(x[k]);
    return out;
}

Eigen::VectorXd ParameterSpace::unit(const Eigen::VectorXd& physical) const {
    Eigen::VectorXd x(dimension());
    for (Eigen::Index k = 0; k < dimension(); ++k)
        x[k] = prior(k).to_unit(physical[static_cast<Eigen::Index>(fitted[static_cast<std::size_t>(k)])]);
    return x;
}

Eigen::MatrixXd ParameterSpace::from_probabilities(const Eigen::MatrixXd& u) const {
    Eigen::MatrixXd x(u.rows(), u.cols());
    for (Eigen::Index k = 0; k < u.cols(); ++k)
        for (Eigen::Index r = 0; r < u.rows(); ++r) x(r, k) = prior(k).quantile_unit(u(r, k));
    return x;
}

ParameterSpace parameter_space(const Settings& settings) {
    ParameterSpace space;
    space.parameters = model_parameters(settings);
    space.values.resize(static_cast<Eigen::Index>(space.parameters.size()));
    for (std::size_t p = 0; p < space.parameters.size(); ++p) {
        const std::string name(space.parameters[p].name);
        double& value = space.values[static_cast<Eigen::Index>(p)];
        if (const auto fixed = settings.set.find(name); fixed != settings.set.end()) {
            value = fixed->second;
            continue;
        }
        const Prior& given = settings.priors.at(name);
        space.priors.push_back({to_surrogate(given.kind), given.mean, given.sd, given.lower, given.upper});
        space.priors.back().validate();
        space.fitted.push_back(p);
        value = space.priors.back().from_unit(space.priors.back().quantile_unit(0.5));
    }
    return space;
}

engine::ContactLaw contact_law(const Settings& settings, const Eigen::VectorXd& physical) {
    std::span<const double> values(physical.data(), static_cast<std::size_t>(physical.size()));
    const engine::LawInfo& law = *engine::find_law(settings.law);
    engine::ContactLaw out = law.make(values.first(law.parameters.size()));
    if (auto* cohesive = std::get_if<engine::LinearCohesive>(&out.base)) {
        cohesive->fragile = settings.engine.fragile;
        cohesive->interaction_range = settings.engine.interaction_range;
    }
    values = values.subspan(law.parameters.size());
    for (const std::string& name : settings.effects) {
        const ModelEffect& effect = *find_model_effect(name);
        if (effect.contact) effect.contact->apply(out, values.first(effect.parameters.size()));
        values = values.subspan(effect.parameters.size());
    }
    return out;
}

}  // namespace loam::experiments
