#include "experiments/workflows/benchmarks/against.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <map>

#include "experiments/output/progress.hpp"
#include "experiments/quantile.hpp"
#include "experiments/settings/settings.hpp"
#include "experiments/workflows/benchmarks/benchmarks.hpp"
#include "experiments/workflows/benchmarks/child_process.hpp"
#include "experiments/workflows/benchmarks/engine_work.hpp"

namespace loam::experiments {
namespace {

constexpr std::array known_comparisons{
    Comparison{"linear-cohesive", SharedLaw::cohesive, false},
    Comparison{"linear-cohesive", SharedLaw::cohesive, true},
    Comparison{"linear-cohesive", SharedLaw::linear, true},
    Comparison{"linear-damped", SharedLaw::linear, true},
    Comparison{"hertz-mindlin", SharedLaw::hertz, true},
};

/// What one code has done on one piece of work.
struct Measured {
    std::vector<double> speed, ratio;  // steps a second, this engine's over it
    double contacts = 0;

    void add(const Timing& timing, int steps, double ours) {
        speed.push_back(steps / timing.seconds);
        ratio.push_back(ours / speed.back());
        contacts = timing.contacts;
    }
    SpeedRow row(SpeedRow row) const {
        row.particle_steps_per_s = quantile(speed, 0.5) * row.particles;
        row.contact_steps_per_s = quantile(speed, 0.5) * contacts;
        row.ratio = quantile(ratio, 0.5);
        return row;
    }
};

/// One comparison on one packing, over all codes and repeats.
class Contest {
  public:
    Contest(const Comparison& comparison, const engine::Packing& packing, const AgainstOptions& options)
        : comparison_(comparison), options_(options) {
        work_.law = comparison.shared;
        work_.free_rotation = comparison.free_rotation;
        if (comparison.shared != SharedLaw::cohesive) work_.parameters.cohesion = 0;
        law_ = find_bench_law(comparison.law)->law(work_.parameters);
        how_ = bench_options(comparison.free_rotation);
        work_.packing = seated(packing, law_, comparison.free_rotation);
        work_.grain_density = how_.grain_density;
        work_.damping = how_.damping;
        work_.time_step = engine::Simulation(work_.packing, law_, how_).time_step();
        work_.strain_rate = strain_per_step / work_.time_step;
        work_.warm_up = options.warm_up;
        const double particles = static_cast<double>(packing.radii.size());
        work_.steps = std::max(options.fewest_steps, static_cast<int>(options.work / particles));
    }

    /// This engine, then the code.
    void meet(const InstalledCode& other, const StopToken& stop) {
        const double ours = run_ours();
        const Timing timing = run_other_code(*other.code, other.program, work_, stop);
        others_[other.code].add(timing, work_.steps, ours);
    }

    /// Rows of those that have been measured.
    std::vector<SpeedRow> rows() const {
        std::vector<SpeedRow> rows;
        SpeedRow row{.code = "loam",
                     .law = comparison_.law,
                     .rotation = comparison_.free_rotation ? "free" : "blocked",
                     .particles = static_cast<std::uint32_t>(work_.packing.radii.size()),
                     .its_law = comparison_.law};
        if (!ours_.speed.empty()) rows.push_back(ours_.row(row));
        for (const OtherCode& code : other_codes()) {  // in the order of that table
            const auto found = others_.find(&code);
            if (found == others_.end()) continue;
            row.code = code.name;
            row.its_law = name_of_law(code, comparison_.shared);
            rows.push_back(found->second.row(row));
        }
        return rows;
    }

  private:
    double run_ours() {
        engine::Simulation simulation(work_.packing, law_, how_);
        compress(simulation, strain_per_step);
        simulation.advance(work_.warm_up);
        const Timing timing = timed_steps(simulation, work_.steps);
        ours_.add(timing, work_.steps, work_.steps / timing.seconds);
        return ours_.speed.back();
    }

    const Comparison& comparison_;
    const AgainstOptions& options_;
    engine::ContactLaw law_;
    engine::SimulationOptions how_;
    SharedWork work_;
    Measured ours_;
    std::map<const OtherCode*, Measured> others_;
};

bool takes_part(const InstalledCode& code, const Comparison& comparison) {
    return !name_of_law(*code.code, comparison.shared).empty();
}

std::vector<Comparison> possible_comparisons(const std::vector<InstalledCode>& codes) {
    std::vector<Comparison> possible;
    for (const Comparison& comparison : known_comparisons)
        if (find_bench_law(comparison.law) != nullptr &&
            std::ranges::any_of(codes, [&](const auto& code) { return takes_part(code, comparison); }))
            possible.push_back(comparison);
    return possible;
}

std::string text_of(const std::vector<SpeedRow>& rows) {
    std::string text =
        fmt::format("{:<8} {:>9} {:<16} {:<42} {:>9} {:>14} {:>14} {:>7}\n", "rotation", "particles", "code",
                    "law", "contacts", "particle-steps", "contact-steps", "ratio");
    for (const SpeedRow& row : rows)
        text += fmt::format("{:<8} {:>9} {:<16} {:<42} {:>9.2f} {:>10.2f} M/s {:>10.2f} M/s {:>7.1f}\n",
                            row.rotation, row.particles, row.code, row.its_law,
                            row.contact_steps_per_s / row.particle_steps_per_s,
                            row.particle_steps_per_s / 1e6, row.contact_steps_per_s / 1e6, row.ratio);
    return text +
           "contacts: a particle; ratio: this engine's speed over the code's; medians, one core each\n";
}

}  // namespace

nlohmann::json to_json(const SpeedRow& row) {
    return {{"code", row.code},
            {"law", row.law},
            {"rotation", row.rotation},
            {"particles", row.particles},
            {"threads", row.threads},
            {"particle_steps_per_s", row.particle_steps_per_s},
            {"contact_steps_per_s", row.contact_steps_per_s},
            {"ratio", row.ratio},
            {"its_law", row.its_law}};
}

std::span<const Comparison> comparisons() {
    return known_comparisons;
}

std::size_t other_runs(const std::vector<InstalledCode>& codes, const AgainstOptions& options) {
    std::size_t pairs = 0;
    for (const Comparison& comparison : possible_comparisons(codes))
        for (const InstalledCode& code : codes) pairs += takes_part(code, comparison) ? 1 : 0;
    return pairs * options.particles.size() * static_cast<std::size_t>(options.repeats);
}

AgainstResult compare_codes(std::vector<InstalledCode> codes, const AgainstOptions& options,
                            const StopToken& stop, const std::function<void()>& each) {
    AgainstResult result;
    for (const std::uint32_t particles : options.particles) {
        const engine::Packing packing = bench_packing(particles);
        for (const Comparison& comparison : possible_comparisons(codes)) {
            stop.throw_if_requested();
            Contest contest(comparison, packing, options);
            for (int repeat = 0; repeat < options.repeats; ++repeat)
                std::erase_if(codes, [&](const InstalledCode& code) {
                    if (!takes_part(code, comparison)) return false;
                    each();
                    try {
                        contest.meet(code, stop);
                        return false;
                    } catch (const std::runtime_error& error) {
                        result.failures.push_back(fmt::format("{}: {}", code.code->name, error.what()));
                        return true;
                    }
                });
            std::ranges::copy(contest.rows(), std::back_inserter(result.rows));
        }
    }
    return result;
}

int bench_engine_against(const Settings& settings) {
    std::vector<InstalledCode> installed;
    for (const std::string& name : settings.against) {
        const OtherCode* code = find_code(name);
        if (const auto program = find_program(code->program))
            installed.push_back({code, *program});
        else
            fmt::print(stderr, "loam: {} is not installed (no program {}; Debian package {}) and left out\n",
                       name, code->program, code->package);
    }
    if (installed.empty()) {
        fmt::print(stderr, "loam: none of the codes to compare with is installed\n");
        return 1;
    }
    const AgainstOptions options;
    ProgressOptions shown;
    shown.style = progress_style(settings.quiet);
    Progress progress("other codes", other_runs(installed, options), shown);
    ProgressCount count;
    const AgainstResult result = compare_codes(installed, options, SignalScope::token(), [&] {
        progress.update(count);
        ++count.done;
    });
    progress.finish();
    for (const std::string& failure : result.failures) fmt::print(stderr, "loam: {}\n", failure);
    nlohmann::json rows = nlohmann::json::array();
    for (const SpeedRow& row : result.rows) rows.push_back(to_json(row));
    fmt::print("{}", settings.json ? rows.dump(1) + "\n" : text_of(result.rows));
    const bool any_ran = std::ranges::any_of(result.rows, [](const auto& row) { return row.code != "loam"; });
    return any_ran ? 0 : 1;
}

}  // namespace loam::experiments
