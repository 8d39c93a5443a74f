// Why a test that was left out of the fit is predicted badly: its density, or the model.
#pragma once

#include <cstddef>
#include <filesystem>
#include <string>
#include <vector>

#include "experiments/calibration.hpp"

namespace loam::experiments {

struct HeldOutFindings {
    std::vector<std::string> warnings;  // of tests whose largest stress is predicted badly
    std::size_t runs = 0, failed = 0;   // that were made for them
};

/// For each held-out test whose largest stress is predicted more than 10 % off: by how much, and how much of
/// that is because specimens of the fitted tests of its kind could not be made as dense or loose as measured.
/// That is found by direct runs at the estimate, with its own specimens as far off; their store is in
/// `folder`/held_out. Throws Interrupted, and what a campaign throws.
HeldOutFindings explain_held_out(Campaign& campaign, const lab_data::Sample& sample,
                                 const Calibration& calibration, const std::filesystem::path& folder,
                                 RunLog* log);

}  // namespace loam::experiments
