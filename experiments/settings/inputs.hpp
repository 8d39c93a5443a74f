// What settings say of the data: the sample and the packing that a run reads.
#pragma once

#include <filesystem>
#include <string>

#include "experiments/settings/reading.hpp"
#include "lab_data/data_set.hpp"

namespace loam::experiments {

/// A fingerprint (FNV-1a, 16 hexadecimal digits) of the sample's description and curves and of the packing
/// file (may be empty), so that a run is not resumed on other data. Throws UserError if a file cannot be
/// read.
std::string digest_of_inputs(const lab_data::Sample& sample, const std::filesystem::path& packing);

/// Likewise of a data set; of a curve that is missing only that it is.
std::string digest_of_inputs(const lab_data::DataSet& set);

/// Throws UserError for a path that is not UTF-8: results, configurations and messages, which are, name it.
void demand_utf8(const std::filesystem::path& path, const Origin& origin);

/// Reads the sample or data set that the draft names, checks hold_out and tests against it, and fills in what
/// follows from it: absolute paths, the digest, and `out` if it is not stated. Throws UserError.
void resolve_inputs(Draft& draft);

}  // namespace loam::experiments
