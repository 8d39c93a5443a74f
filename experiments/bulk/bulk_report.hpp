// The document of a bulk study's report (experiments/report/README.md, member `bulk`).
#pragma once

#include <nlohmann/json.hpp>

#include "experiments/bulk/group_statistics.hpp"
#include "experiments/bulk/inverse_kriging.hpp"
#include "experiments/bulk/study.hpp"

namespace loam::experiments {

/// `result` is that of result.json.
nlohmann::json bulk_document(const nlohmann::json& result, const BulkStudy& study,
                             const GroupStatistics& statistics, const lab_data::DataSet& set,
                             const SharedEnsemble& ensemble, const Settings& settings);

}  // namespace loam::experiments
