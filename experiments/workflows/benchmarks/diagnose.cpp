// loam bench diagnose: blind twins, each diagnosed as loam diagnose would, from training runs that all share.
// What is hidden stands in truth.json, which no diagnosis is given.
#include <fmt/format.h>
#include <omp.h>

#include <atomic>
#include <chrono>
#include <exception>
#include <fstream>
#include <mutex>

#include "experiments/ensemble/stop_token.hpp"
#include "experiments/output/atomic_file.hpp"
#include "experiments/settings/run_folder.hpp"
#include "experiments/workflows/benchmarks/benchmarks.hpp"
#include "experiments/workflows/benchmarks/diagnosis_score.hpp"
#include "experiments/workflows/sample_diagnosis.hpp"

namespace loam::experiments {
namespace {

using nlohmann::json;

/// The model as the diagnosis of a twin starts from it.
Settings settings_for(const TwinFactory& factory, const TwinTruth& twin) {
    Settings settings = factory.model();
    settings.jobs = 1;  // the twins are diagnosed side by side
    for (const ModelEffect* effect : factory.effects())
        if (!twin.withheld || effect->name != twin.effects.front())
            settings.diagnosis.candidates.emplace_back(effect->name);
    return settings;
}

/// Diagnoses one twin, or reads what was found of it before.
json diagnosed(const TwinFactory& factory, const Settings& settings, const lab_data::Sample& sample,
               const std::filesystem::path& place) {
    const std::filesystem::path file = place / "result.json";
    if (std::ifstream before(file); before) return json::parse(before);
    factory.prepare(place);
    RunLog log(place / "log.txt");
    json result;
    try {
        result = diagnose_sample(settings, sample, place, log, [&](const std::string& step) {
                     log.write(step);
                 }).result;
    } catch (const Interrupted&) {
        throw;
    } catch (const std::runtime_error& error) {
        result = {
            {"verdict", "failed"}, {"effects", json::array()}, {"text", error.what()}, {"shrink", nullptr}};
    }
    write_file_atomically(file, result.dump(1) + "\n");
    return result;
}

TwinVerdict verdict_of(const json& result) {
    return {result["verdict"], result["effects"],
            result["shrink"].is_number() ? result["shrink"].get<double>() : 0.0};
}

std::vector<TwinVerdict> diagnose_all(const TwinFactory& factory, const std::vector<TwinTruth>& twins,
                                      const std::vector<lab_data::Sample>& samples,
                                      const std::filesystem::path& folder, RunLog& log, bool quiet) {
    std::vector<TwinVerdict> out(twins.size());
    const auto started = std::chrono::steady_clock::now();
    std::exception_ptr error;
    std::mutex mutex;
    int done = 0;
#pragma omp parallel for schedule(dynamic)
    for (std::size_t k = 0; k < twins.size(); ++k) {
        {
            const std::scoped_lock lock(mutex);
            if (error) continue;
        }
        try {
            out[k] = verdict_of(diagnosed(factory, settings_for(factory, twins[k]), samples[k],
                                          folder / "diagnoses" / twins[k].name));
            const std::scoped_lock lock(mutex);
            ++done;
            const double minutes =
                std::chrono::duration<double>(std::chrono::steady_clock::now() - started).count() / 60;
            const double left = minutes / done * static_cast<double>(twins.size()) - minutes;
            const std::string line =
                fmt::format("{}: {} ({} of {} twins, {:.0f} min, {:.0f} min left)", twins[k].name,
                            out[k].verdict, done, twins.size(), minutes, left);
            log.write(line);
            if (!quiet) fmt::print(stderr, "{}\n", line);
        } catch (...) {
            const std::scoped_lock lock(mutex);
            if (!error) error = std::current_exception();
        }
    }
    if (error) std::rethrow_exception(error);
    return out;
}

}  // namespace

int bench_diagnose(const Settings& given) {
    const RunFolder folder(given);
    RunLog log(folder.file("log.txt"));
    TwinFactory factory(given, folder.path(), log);
    std::vector<TwinTruth> twins = factory.plan();
    if (given.twins > 0 && static_cast<std::size_t>(given.twins) < twins.size())
        twins.resize(static_cast<std::size_t>(given.twins));
    const std::vector<lab_data::Sample> samples = factory.measure(twins);
    json truths = json::array();
    for (const TwinTruth& twin : twins) truths.push_back(to_json(twin));
    write_file_atomically(folder.file("truth.json"), truths.dump(1) + "\n");
    const std::vector<TwinVerdict> verdicts =
        diagnose_all(factory, twins, samples, folder.path(), log, given.quiet);
    const DiagnosisScore figures = score(twins, verdicts);
    fmt::print("{}", given.json ? to_json(figures).dump(1) + "\n" : to_text(figures));
    return 0;
}

}  // namespace loam::experiments
