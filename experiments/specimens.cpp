#include "experiments/specimens.hpp"

#include <algorithm>
#include <stdexcept>
#include <utility>

#include "experiments/preparation_stiffness.hpp"
#include "lab_data/packing_file.hpp"

namespace loam::experiments {
namespace {

Specimen make(const SpecimenSettings& settings, double porosity, const SpecimenShape& shape,
              std::uint64_t seed, const StopToken& stop) {
    engine::BoxedPackingOptions options;
    options.particles = shape.particles;
    options.size_spread = settings.size_spread;
    options.stress = 1000 * settings.preparation_stress_kPa;
    // Beyond what spheres can reach, the nearest reachable packing is made; its porosity is reported.
    options.target_porosity = std::clamp(porosity, 0.06, 0.59);
    options.stiffness_ratio = preparation_stiffness;
    options.seed = seed;
    const auto cancelled = [&] { return stop.stop_requested(); };
    if (!shape.proportions) {
        engine::PackingResult made = engine::make_packing(options, cancelled);
        return {std::move(made.packing), std::nullopt, made.porosity, made.reached, made.stopped_by};
    }
    options.proportions = *shape.proportions;
    engine::BoxedPackingResult made = engine::make_boxed_packing(options, cancelled);
    return {std::move(made.packing), made.box, made.porosity, made.reached, made.stopped_by};
}

}  // namespace

std::shared_ptr<const Specimen> SpecimenPool::get(const SpecimenSettings& settings, double porosity,
                                                  const SpecimenShape& shape, std::uint64_t seed,
                                                  const StopToken& stop) {
    Key key{porosity, settings.size_spread, settings.preparation_stress_kPa, shape.particles, {}, seed};
    if (shape.proportions)
        for (int axis = 0; axis < 3; ++axis)
            key.proportions[static_cast<std::size_t>(axis)] = (*shape.proportions)[axis];
    std::promise<Made> promise;
    std::shared_future<Made> future;
    bool mine = false;
    {
        const std::lock_guard lock(mutex_);
        auto [at, inserted] = made_.try_emplace(key);
        if (inserted) at->second = promise.get_future().share();
        mine = inserted;
        future = at->second;
        if (inserted) {
            order_.push_back(key);
            particles_ += key.particles;
        }
        while (particles_ > most_particles && order_.size() > 1) {
            particles_ -= order_.front().particles;
            made_.erase(order_.front());
            order_.pop_front();
        }
    }
    if (!mine) return future.get();
    try {
        promise.set_value(std::make_shared<const Specimen>(make(settings, porosity, shape, seed, stop)));
    } catch (...) {
        if (stop.stop_requested()) {
            promise.set_exception(std::make_exception_ptr(Interrupted()));
            throw Interrupted();
        }
        promise.set_exception(std::current_exception());
    }
    return future.get();
}

SpecimenPool& specimen_pool() {
    static SpecimenPool pool;
    return pool;
}

engine::Packing load_packing(const std::filesystem::path& file) {
    const lab_data::PackingFile read = lab_data::read_packing_file(file);
    const auto n = static_cast<Eigen::Index>(read.spheres.size());
    engine::Packing packing;
    packing.cell = Eigen::Vector3d(read.cell[0], read.cell[1], read.cell[2]).asDiagonal();
    packing.centres.resize(3, n);
    packing.radii.resize(n);
    for (Eigen::Index p = 0; p < n; ++p) {
        const lab_data::PackingSphere& sphere = read.spheres[static_cast<std::size_t>(p)];
        packing.centres.col(p) << sphere.centre[0], sphere.centre[1], sphere.centre[2];
        packing.radii[p] = sphere.radius;
    }
    return packing;
}

}  // namespace loam::experiments
