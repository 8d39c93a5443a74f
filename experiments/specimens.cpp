#include "experiments/specimens.hpp"

#include <algorithm>
#include <stdexcept>

#include "lab_data/packing_file.hpp"

namespace loam::experiments {

double target_porosity(const Settings& settings, const lab_data::Test& test) {
    if (settings.specimen.porosity) return *settings.specimen.porosity;
    if (test.initial_void_ratio) return *test.initial_void_ratio / (1 + *test.initial_void_ratio);
    return engine::PackingOptions{}.target_porosity;
}

std::shared_ptr<const engine::PackingResult> SpecimenPool::get(double porosity, std::uint32_t particles,
                                                               std::uint64_t seed, const StopToken& stop) {
    const Key key{porosity, particles, seed};
    std::promise<Packing> promise;
    std::shared_future<Packing> future;
    bool mine = false;
    {
        const std::lock_guard lock(mutex_);
        auto [at, inserted] = made_.try_emplace(key);
        if (inserted) at->second = promise.get_future().share();
        mine = inserted;
        future = at->second;
        if (inserted) order_.push_back(key);
        if (order_.size() > most_kept) {
            made_.erase(order_.front());
            order_.pop_front();
        }
    }
    if (!mine) return future.get();
    try {
        engine::PackingOptions options;
        options.particles = particles;
        options.size_spread = settings_.specimen.size_spread;
        options.stress = 1000 * settings_.specimen.preparation_stress_kPa;
        // Beyond what spheres can reach, the nearest reachable packing is made; its porosity is reported.
        options.target_porosity = std::clamp(porosity, 0.06, 0.59);
        options.seed = seed;
        promise.set_value(std::make_shared<const engine::PackingResult>(
            engine::make_packing(options, [&] { return stop.stop_requested(); })));
    } catch (...) {
        if (stop.stop_requested()) {
            promise.set_exception(std::make_exception_ptr(Interrupted()));
            throw Interrupted();
        }
        promise.set_exception(std::current_exception());
    }
    return future.get();
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
