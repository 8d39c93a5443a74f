#include "experiments/settings/inputs.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cctype>

#include "experiments/density.hpp"
#include "experiments/lab_tests/registry.hpp"
#include "experiments/output/file_descriptor.hpp"
#include "experiments/settings/conversion.hpp"
#include "experiments/settings/validation.hpp"
#include "lab_data/nearest_name.hpp"
#include "lab_data/utf8.hpp"

namespace loam::experiments {
namespace {

namespace fs = std::filesystem;

constexpr int bulk_runs = 959;    // as De Pue et al. 2019
constexpr double bulk_haste = 4;  // against 1.5: strains change by 3e-4 to 9e-4, less than packings scatter
// A diagnosis is several calibrations, which end within an hour on two cores so.
constexpr int diagnosis_rounds = 2;
constexpr double diagnosis_haste = 3;

/// FNV-1a (Fowler, Noll, Vo), 64 bits.
class Fingerprint {
  public:
    void add(std::string_view bytes) {
        for (const char c : bytes) add_byte(static_cast<unsigned char>(c));
        add_byte(0);  // so that "ab","c" is not "a","bc"
    }
    std::string text() const { return fmt::format("{:016x}", state_); }

  private:
    void add_byte(unsigned char byte) { state_ = (state_ ^ byte) * 0x100000001b3u; }
    std::uint64_t state_ = 0xcbf29ce484222325u;
};

/// A name that is safe as a part of a folder's name.
std::string as_file_name(std::string name) {
    for (char& c : name)
        if (!std::isalnum(static_cast<unsigned char>(c)) && c != '.' && c != '_') c = '-';
    return name;
}

/// Adds the folder's own .toml and .csv files and those that are named.
void add_files(Fingerprint& fingerprint, const fs::path& folder, std::vector<fs::path> files) {
    for (const auto& entry : fs::directory_iterator(folder))
        if (entry.path().extension() == ".toml" || entry.path().extension() == ".csv")
            files.push_back(entry.path());
    std::ranges::sort(files);
    files.erase(std::unique(files.begin(), files.end()), files.end());
    for (const fs::path& file : files) {
        fingerprint.add(file.lexically_relative(folder).string());
        fingerprint.add(read_whole_file(file));
    }
}

/// Replaces each file that is held out by its name in the sample.
void resolve_hold_out(Draft& draft, const lab_data::Sample& sample) {
    std::vector<std::string_view> valid;
    for (const lab_data::Test& test : sample.tests) valid.push_back(test.file);
    for (std::string& file : draft.settings.hold_out) {
        // A path to the file is as good as its name.
        const std::string inside =
            fs::absolute(file).lexically_normal().lexically_relative(sample.folder).string();
        if (std::ranges::find(valid, inside) != valid.end()) file = inside;
        if (std::ranges::find(valid, file) == valid.end())
            throw fault_at(origin_of(draft.origins, "hold_out"), file,
                           fmt::format("is not a test of the sample {}", sample.name),
                           lab_data::suggest_name(file, valid));
    }
}

constexpr std::array<std::string_view, 2> crossed_kinds{"triaxial", "direct_shear"};

/// Demands that each kind asked for is there, and that something is left to do.
void check_tests(Draft& draft, const lab_data::Sample& sample) {
    Settings& settings = draft.settings;
    const bool crossed = settings.verb == "crosstest";
    if (crossed && settings.tests.empty()) settings.tests.assign(crossed_kinds.begin(), crossed_kinds.end());
    const auto contains = [](const auto& names, std::string_view name) {
        return std::ranges::find(names, name) != names.end();
    };
    const Origin origin = origin_of(draft.origins, "tests");
    std::vector<std::string_view> there, fitted;
    for (const lab_data::Test& test : sample.tests) {
        there.push_back(to_string(test.kind));
        const bool wanted = settings.tests.empty() || contains(settings.tests, there.back());
        if (wanted && !contains(settings.hold_out, test.file)) fitted.push_back(there.back());
    }
    for (const std::string_view kind : crossed_kinds)
        if (crossed && !contains(fitted, kind))
            throw fault_at({.name = "sample"}, settings.sample.string(),
                           fmt::format("has no {} test to fit{}", kind,
                                       contains(there, kind) ? ", as options leave it out" : ""),
                           contains(there, kind)
                               ? "leave --tests out, and hold out fewer tests"
                               : "crosstest compares triaxial and direct shear tests of one sample");
    for (const std::string& kind : settings.tests) {
        if (!contains(there, kind))
            throw fault_at(origin, kind, fmt::format("is not among the tests of the sample {}", sample.name),
                           "see loam check SAMPLE");
    }
    for (const lab_data::Test& test : sample.tests)
        if (contains(settings.hold_out, test.file) && !settings.tests.empty() &&
            !contains(settings.tests, to_string(test.kind)))
            throw fault_at(
                origin_of(draft.origins, "hold_out"), test.file,
                fmt::format("is of kind {}, which is not among the tests asked for", to_string(test.kind)),
                "add its kind to tests, or leave it out");
    if ((settings.verb == "calibrate" || settings.verb == "diagnose") && fitted.empty())
        throw fault_at(origin_of(draft.origins, "hold_out"), "", "leaves no test to fit", "hold out fewer");
}

/// Demands that specimens of the tests asked for can be made.
void check_specimens(const Settings& settings, const lab_data::Sample& sample) {
    constexpr double any_porosity = 0.4;
    for (const lab_data::Test& test : sample.tests) {
        const bool wanted = settings.tests.empty() ||
                            std::ranges::find(settings.tests, to_string(test.kind)) != settings.tests.end();
        if (!wanted) continue;
        target_porosity(settings, sample, test);
        lab_test(test.kind).shape(settings, sample, test, any_porosity,
                                  static_cast<std::uint32_t>(std::max(100, settings.particles)));
    }
}

/// Reads the sample, checks what is asked of it, and returns its name.
std::string resolve_sample(Draft& draft) {
    Settings& settings = draft.settings;
    // Read by the path as the user wrote it, so that the messages show that.
    lab_data::Sample sample = lab_data::read_sample(settings.sample);
    sample.folder = fs::absolute(sample.folder).lexically_normal();
    settings.sample = fs::weakly_canonical(settings.sample);
    if (!settings.packing.empty()) settings.packing = fs::weakly_canonical(settings.packing);
    if (const auto spread = spread_of_grading(sample);
        spread && !draft.origins.contains("specimen.size_spread"))
        settings.specimen.size_spread = *spread;
    resolve_hold_out(draft, sample);
    check_tests(draft, sample);
    check_specimens(settings, sample);
    if (settings.verb == "diagnose") {
        if (!draft.origins.contains("engine.haste")) settings.engine.haste = diagnosis_haste;
        if (!draft.origins.contains("calibration.max_rounds"))
            settings.calibration.max_rounds = diagnosis_rounds;
    }
    settings.inputs_digest = digest_of_inputs(sample, settings.packing);
    return sample.name;
}

/// Demands that the covariate by which samples are paired is there: without it they are not.
void check_pairing(const Draft& draft, const lab_data::DataSet& set) {
    const std::string& name = draft.settings.bulk.paired_by;
    const std::vector<std::string_view> valid(set.covariates.begin(), set.covariates.end());
    if (name.empty() || std::ranges::find(valid, name) != valid.end()) return;
    throw fault_at(
        origin_of(draft.origins, "bulk.paired_by"), name,
        fmt::format("is not a covariate of the data set {}", set.name),
        valid.empty() ? "leave it out: the data set has none" : lab_data::suggest_name(name, valid));
}

/// Likewise a data set; one ensemble for all its samples is larger, and is run faster, than one sample's.
std::string resolve_data_set(Draft& draft) {
    Settings& settings = draft.settings;
    lab_data::DataSet set = lab_data::read_data_set(settings.sample);
    if (set.kind != lab_data::TestKind::oedometer)
        throw fault_at({.name = "sample"}, settings.sample.string(),
                       fmt::format("holds tests of kind {}", to_string(set.kind)),
                       "loam bulk calibrates data sets of kind oedometer");
    for (const auto& [is_given, option] :
         {std::pair{!settings.packing.empty(), "packing"}, std::pair{!settings.hold_out.empty(), "hold_out"}})
        if (is_given)
            throw fault_at(origin_of(draft.origins, option), "", "has no meaning for a data set",
                           "leave it out");
    for (const std::string& kind : settings.tests)
        if (kind != to_string(set.kind))
            throw fault_at(origin_of(draft.origins, "tests"), kind,
                           fmt::format("is not the kind of the data set {}", set.name),
                           fmt::format("its tests are of kind {}: leave it out", to_string(set.kind)));
    check_pairing(draft, set);
    set.folder = fs::absolute(set.folder).lexically_normal();
    settings.sample = fs::weakly_canonical(settings.sample);
    settings.inputs_digest = digest_of_inputs(set);
    if (!draft.origins.contains("runs")) settings.runs = bulk_runs;
    if (!draft.origins.contains("engine.haste")) settings.engine.haste = bulk_haste;
    return set.name;
}

/// The paths of a run, as the user wrote them or as they have become.
void demand_utf8_paths(const Draft& draft) {
    const Settings& settings = draft.settings;
    for (const auto& [path, name] :
         {std::pair{&settings.sample, "sample"}, std::pair{&settings.packing, "packing"},
          std::pair{&settings.out, "out"}})
        demand_utf8(*path, origin_of(draft.origins, name));
}

}  // namespace

void demand_utf8(const fs::path& path, const Origin& origin) {
    const std::string& text = path.native();
    for (std::size_t i = 0; i < text.size();) {
        const std::size_t length = lab_data::utf8_character_length(std::string_view(text).substr(i));
        if (length == 0)
            throw fault_at(origin, text, "is not UTF-8, as results that name it must be",
                           "rename what is so called, or give another path");
        i += length;
    }
}

std::string digest_of_inputs(const lab_data::Sample& sample, const fs::path& packing) {
    std::vector<fs::path> files;
    for (const lab_data::Test& test : sample.tests) files.push_back(sample.folder / test.file);
    Fingerprint fingerprint;
    add_files(fingerprint, sample.folder, std::move(files));
    if (!packing.empty()) fingerprint.add(read_whole_file(packing));
    return fingerprint.text();
}

std::string digest_of_inputs(const lab_data::DataSet& set) {
    std::vector<fs::path> files;
    // A curve that cannot be read is reported with its sample; here only that it is so counts.
    std::error_code error;
    for (const lab_data::DataSetRow& row : set.rows)
        if (row.readable() || fs::is_regular_file(set.folder / row.file, error))
            files.push_back(set.folder / row.file);
    Fingerprint fingerprint;
    add_files(fingerprint, set.folder, std::move(files));
    return fingerprint.text();
}

void resolve_inputs(Draft& draft) {
    Settings& settings = draft.settings;
    demand_utf8_paths(draft);
    std::string name = settings.benchmark;
    if (settings.verb != "bench") {
        if (settings.sample.empty())
            throw fault_at({.name = settings.verb == "bulk" ? "dataset" : "sample"}, "", "is missing",
                           fmt::format("name its folder, as in: loam {} lab_data/sets/{}", settings.verb,
                                       settings.verb == "bulk" ? "flanders_twin_125" : "dobrany_sand"));
        name = settings.verb == "bulk" ? resolve_data_set(draft) : resolve_sample(draft);
    }
    if (settings.out.empty()) settings.out = fs::path("runs") / as_file_name(settings.verb + "-" + name);
    settings.out = fs::weakly_canonical(fs::absolute(settings.out));
    demand_utf8_paths(draft);
}

}  // namespace loam::experiments
