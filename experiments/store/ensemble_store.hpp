// The runs of an ensemble on disk, in a run folder. A finished run is never lost and never run twice,
// whatever kills the process: append() returns when the run is in ensemble.journal and on the disk;
// checkpoints move all runs to ensemble.h5 (written beside it, synced, renamed) and remove the journal only
// then. Killed at any moment, every appended run is in one of the two, or in both. The bytes of ensemble.h5
// depend on the runs alone, not on their order or on how often the process was killed.
#pragma once

#include <chrono>
#include <filesystem>
#include <map>
#include <mutex>
#include <optional>
#include <vector>

#include "experiments/ensemble/run_record.hpp"
#include "experiments/store/folder_lock.hpp"
#include "experiments/store/h5_file.hpp"
#include "experiments/store/header.hpp"
#include "experiments/store/journal.hpp"

namespace loam::experiments {

struct StoreOptions {
    double checkpoint_seconds = 60;  // append() makes a checkpoint when the last one is older than this; > 0
    /// Throws std::invalid_argument.
    void validate() const;
};

/// What opening the store found of an earlier, killed session.
struct StoreRecovery {
    std::size_t journal_records = 0;  // finished runs that were only in the journal
    std::size_t damaged_bytes =
        0;  // of the journal: torn by the kill, or damaged; the runs in it count as not run
};

class EnsembleStore {
  public:
    /// Opens the ensemble in `folder`, or begins one (the folder is made if need be). Throws
    /// lab_data::UserError: the folder is not writable or another process works in it; ensemble.h5 belongs to
    /// another campaign (says what differs), or is damaged. Throws StorageError if the disk is full, and
    /// std::invalid_argument if header or options are not valid.
    EnsembleStore(const std::filesystem::path& folder, EnsembleHeader header,
                  const StoreOptions& options = {});

    const EnsembleHeader& header() const { return header_; }
    const StoreRecovery& recovery() const { return recovery_; }
    const std::filesystem::path& file() const { return h5_path_; }

    // The following may be called from any thread.
    std::size_t size() const;
    std::optional<RunRecord> find(std::uint64_t index) const;
    /// By rising index.
    std::vector<RunRecord> records() const;

    /// Adds a finished run: on the disk when this returns. Throws StorageError or lab_data::UserError if it
    /// cannot be written, and then the store is as before (or, where the run was written and only the
    /// checkpoint due was not, holds the run). Throws std::invalid_argument if the record does not fit the
    /// header: wrong sizes, parameters or outputs that are not finite, a failure with outputs or without a
    /// reason, an index that is there already.
    void append(RunRecord record);

    /// Brings ensemble.h5 up to date. Throws StorageError or lab_data::UserError; nothing is lost then.
    void checkpoint();

  private:
    void check_fits(const RunRecord& record) const;
    void recover_journal();
    void write_h5();
    void move_to_h5();

    EnsembleHeader header_;
    StoreOptions options_;
    std::filesystem::path h5_path_;
    std::filesystem::path journal_path_;
    std::optional<FolderLock> lock_;
    StoreRecovery recovery_;
    mutable std::mutex mutex_;
    std::map<std::uint64_t, RunRecord> records_;
    std::optional<Journal> journal_;
    bool dirty_ = false;  // records_ holds more than ensemble.h5
    std::chrono::steady_clock::time_point last_checkpoint_;
};

/// Reads the ensemble in `folder` without changing or locking it, even while another process adds to it.
/// Throws lab_data::UserError if there is none, or if it is damaged.
EnsembleContents load_ensemble(const std::filesystem::path& folder);

}  // namespace loam::experiments
