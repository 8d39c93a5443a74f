// ensemble.h5: the ensemble in a form that any HDF5 reader understands without this program.
//
//   /parameters   [n x d] SI; attributes name, unit, lower, upper [d]
//   /outputs      [n x m] NaN in the rows of failed runs
//   /diagnostics  [n x k] NaN where not measured; attributes name, unit [k]
//   /output_columns/{file, channel, unit, x_channel, x_unit, x}  [m] what each column of /outputs is
//   /index /purpose /packing_seed /particles /status ("ok" | "failed") /reason  [n]
//   attributes of the file: format, format_version, campaign_seed, and those of the header
//
// The runs are in the order of their index and nothing in it depends on time, place or order of finishing:
// equal contents are equal bits. The first 512 bytes are a user block (which HDF5 passes over) with a
// checksum of the rest, so that a damaged file is recognised before HDF5 sees it.
#pragma once

#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

#include "experiments/ensemble/run_record.hpp"
#include "experiments/store/header.hpp"

namespace loam::experiments {

struct EnsembleContents {
    EnsembleHeader header;
    std::vector<RunRecord> records;  // by rising index
};

/// The bytes of the file. The records must fit the header (EnsembleStore sees to that). Throws
/// std::runtime_error if HDF5 fails. Any thread.
std::string encode_ensemble(const EnsembleContents& contents);

/// The reverse; `path` is for the messages. Throws lab_data::UserError if the bytes are not an ensemble, are
/// damaged, or are of another format version. Any thread.
EnsembleContents decode_ensemble(std::string_view bytes, const std::filesystem::path& path);

}  // namespace loam::experiments
