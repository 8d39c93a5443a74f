// The ensemble's journal: finished runs that are not in ensemble.h5 yet, one checksummed record each, on the
// disk before the run counts as finished. Whatever kills the process or the machine, a record is there whole
// or it is recognised as torn.
//
// File: a preamble of 32 bytes (magic, format version, fingerprint of the header, CRC-64), then records of
// (magic, payload length, payload, CRC-64 of length and payload seeded with the fingerprint).
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

#include "experiments/ensemble/run_record.hpp"
#include "experiments/output/file_descriptor.hpp"

namespace loam::experiments {

struct JournalContents {
    std::vector<RunRecord> records;  // in the order of finishing
    std::size_t damaged_bytes = 0;   // torn or damaged, and left out
    bool foreign = false;            // written under another header: nothing was read
};

/// Reads what is whole. A damaged record costs itself alone: reading goes on at the next whole one.
JournalContents parse_journal(std::string_view bytes, std::uint64_t fingerprint);

/// The bytes of a record in the journal.
std::string journal_record(const RunRecord& record, std::uint64_t fingerprint);

/// Appends to a journal, which it creates at the first record (replacing one that is there: its records must
/// be in ensemble.h5 by then).
class Journal {
  public:
    Journal(std::filesystem::path path, std::uint64_t fingerprint);

    /// The record is on the disk when this returns. Throws lab_data::UserError or StorageError, and then the
    /// journal is as it was before.
    void append(const RunRecord& record);

    /// Removes the file, durably. Call it when its records are safe elsewhere.
    void remove();

  private:
    void create();

    std::filesystem::path path_;
    std::uint64_t fingerprint_;
    FileDescriptor file_;
    std::int64_t size_ = 0;
};

}  // namespace loam::experiments
