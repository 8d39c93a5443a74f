#include "experiments/store/ensemble_store.hpp"

#include <fmt/format.h>

#include <limits>
#include <stdexcept>
#include <utility>

#include "experiments/output/atomic_file.hpp"
#include "experiments/output/file_descriptor.hpp"
#include "lab_data/user_error.hpp"

namespace loam::experiments {
namespace {

constexpr const char* h5_name = "ensemble.h5";
constexpr const char* journal_name = "ensemble.journal";

void require_run(bool condition, const std::string& message) {
    if (!condition) throw std::invalid_argument("EnsembleStore: " + message);
}

[[noreturn]] void refuse_other_campaign(const std::filesystem::path& path, const std::string& difference) {
    throw lab_data::UserError(
        {.file = path.string(),
         .constraint = "belongs to another campaign: " + difference,
         .remedy = "choose another folder with --out, or delete this one's ensemble to run it again"});
}

std::string shown(const std::vector<std::string>& differences) {
    constexpr std::size_t most = 3;
    std::string text;
    for (std::size_t i = 0; i < differences.size() && i < most; ++i)
        text += (i > 0 ? "; " : "") + differences[i];
    if (differences.size() > most) text += fmt::format("; and {} more", differences.size() - most);
    return text;
}

/// Adds the journal's runs to those of ensemble.h5. A run in both (killed between the two steps of a
/// checkpoint) must be the same in both.
std::size_t merge(std::map<std::uint64_t, RunRecord>& records, std::vector<RunRecord> journal,
                  const std::filesystem::path& journal_path) {
    std::size_t added = 0;
    for (RunRecord& record : journal) {
        const std::uint64_t index = record.spec.index;
        const auto [place, is_new] = records.try_emplace(index, std::move(record));
        if (is_new) ++added;
        // try_emplace leaves the record alone when it does not take it.
        else if (!same_record(place->second, record))
            refuse_other_campaign(journal_path,
                                  fmt::format("run {} differs from the one in {}", index, h5_name));
    }
    return added;
}

std::map<std::uint64_t, RunRecord> by_index(std::vector<RunRecord> records) {
    std::map<std::uint64_t, RunRecord> map;
    for (RunRecord& record : records) {
        const std::uint64_t index = record.spec.index;
        map.emplace(index, std::move(record));
    }
    return map;
}

std::vector<RunRecord> values_of(const std::map<std::uint64_t, RunRecord>& map) {
    std::vector<RunRecord> records;
    records.reserve(map.size());
    for (const auto& [index, record] : map) records.push_back(record);
    return records;
}

}  // namespace

void StoreOptions::validate() const {
    if (!(checkpoint_seconds > 0))
        throw std::invalid_argument(
            fmt::format("StoreOptions: checkpoint_seconds = {} must be positive", checkpoint_seconds));
}

EnsembleStore::EnsembleStore(const std::filesystem::path& folder, EnsembleHeader header,
                             const StoreOptions& options)
    : header_(std::move(header)),
      options_(options),
      h5_path_(folder / h5_name),
      journal_path_(folder / journal_name) {
    validate(header_);
    options_.validate();
    make_writable_folder(folder);
    lock_.emplace(folder);
    const std::optional<std::string> bytes = read_file_if_there(h5_path_);
    if (bytes) {
        EnsembleContents contents = decode_ensemble(*bytes, h5_path_);
        if (const auto found = differences(contents.header, header_); !found.empty())
            refuse_other_campaign(h5_path_, shown(found));
        records_ = by_index(std::move(contents.records));
    }
    recover_journal();
    // From the first moment on there is a file that says what this ensemble is of, and a journal left behind
    // is replaced by the next one only when its runs are safe.
    if (!bytes || dirty_) write_h5();
    journal_.emplace(journal_path_, fingerprint(header_));
    journal_->remove();
}

void EnsembleStore::recover_journal() {
    const std::string bytes = read_file_if_there(journal_path_).value_or("");
    JournalContents journal = parse_journal(bytes, fingerprint(header_));
    if (journal.foreign) refuse_other_campaign(journal_path_, "it was begun under other settings");
    recovery_.damaged_bytes = journal.damaged_bytes;
    recovery_.journal_records = merge(records_, std::move(journal.records), journal_path_);
    dirty_ = recovery_.journal_records > 0;
}

std::size_t EnsembleStore::size() const {
    const std::scoped_lock lock(mutex_);
    return records_.size();
}

std::optional<RunRecord> EnsembleStore::find(std::uint64_t index) const {
    const std::scoped_lock lock(mutex_);
    const auto place = records_.find(index);
    return place == records_.end() ? std::nullopt : std::optional(place->second);
}

std::vector<RunRecord> EnsembleStore::records() const {
    const std::scoped_lock lock(mutex_);
    return values_of(records_);
}

void EnsembleStore::check_fits(const RunRecord& record) const {
    const auto sized = [](const Eigen::VectorXd& values, std::size_t size) {
        return static_cast<std::size_t>(values.size()) == size;
    };
    const std::string run = fmt::format("run {}: ", record.spec.index);
    require_run(!records_.contains(record.spec.index), run + "is stored already");
    require_run(!record.spec.purpose.empty(), run + "has no purpose");
    require_run(
        record.spec.purpose.find('\0') == std::string::npos && record.reason.find('\0') == std::string::npos,
        run + "a text holds a byte 0");
    require_run(
        sized(record.spec.parameters, header_.parameters.size()) && record.spec.parameters.allFinite(),
        run + fmt::format("needs {} finite parameters", header_.parameters.size()));
    require_run(record.ok == record.reason.empty(), run + "needs a reason if and only if it failed");
    require_run(sized(record.outputs, record.ok ? header_.outputs.size() : 0) && record.outputs.allFinite(),
                run + fmt::format("needs {} finite outputs, or none if it failed", header_.outputs.size()));
    require_run(sized(record.diagnostics, header_.diagnostics.size()),
                run + fmt::format("needs {} diagnostics", header_.diagnostics.size()));
}

void EnsembleStore::append(RunRecord record) {
    const std::scoped_lock lock(mutex_);
    // A run that failed early has measured nothing. Stored and read again it is the same.
    if (!record.ok && record.diagnostics.size() == 0)
        record.diagnostics = Eigen::VectorXd::Constant(static_cast<Eigen::Index>(header_.diagnostics.size()),
                                                       std::numeric_limits<double>::quiet_NaN());
    check_fits(record);
    journal_->append(record);
    dirty_ = true;
    const std::uint64_t index = record.spec.index;
    records_.emplace(index, std::move(record));
    const std::chrono::duration<double> age = std::chrono::steady_clock::now() - last_checkpoint_;
    if (age.count() > options_.checkpoint_seconds) move_to_h5();
}

void EnsembleStore::checkpoint() {
    const std::scoped_lock lock(mutex_);
    if (dirty_) move_to_h5();
}

void EnsembleStore::move_to_h5() {
    write_h5();
    journal_->remove();  // only now: its runs are safe elsewhere
}

void EnsembleStore::write_h5() {
    write_file_atomically(h5_path_, encode_ensemble({header_, values_of(records_)}));
    dirty_ = false;
    last_checkpoint_ = std::chrono::steady_clock::now();
}

EnsembleContents load_ensemble(const std::filesystem::path& folder) {
    const std::filesystem::path h5_path = folder / h5_name;
    const std::filesystem::path journal_path = folder / journal_name;
    // The journal first: should a checkpoint come in between, its runs are in the new ensemble.h5 too.
    const std::string journal = read_file_if_there(journal_path).value_or("");
    EnsembleContents contents = decode_ensemble(read_whole_file(h5_path), h5_path);
    JournalContents rest = parse_journal(journal, fingerprint(contents.header));
    if (rest.foreign) refuse_other_campaign(journal_path, "it was begun under other settings");
    std::map<std::uint64_t, RunRecord> records = by_index(std::move(contents.records));
    merge(records, std::move(rest.records), journal_path);
    contents.records = values_of(records);
    return contents;
}

}  // namespace loam::experiments
