#include "experiments/ensemble/run_record.hpp"

#include <cstring>

namespace loam::experiments {
namespace {

bool same_bits(const Eigen::VectorXd& a, const Eigen::VectorXd& b) {
    if (a.size() != b.size()) return false;
    const auto bytes = static_cast<std::size_t>(a.size()) * sizeof(double);
    return bytes == 0 || std::memcmp(a.data(), b.data(), bytes) == 0;
}

}  // namespace

bool same_run(const RunSpec& a, const RunSpec& b) {
    return a.index == b.index && a.purpose == b.purpose && a.packing_seed == b.packing_seed &&
           a.particles == b.particles && same_bits(a.parameters, b.parameters);
}

bool same_record(const RunRecord& a, const RunRecord& b) {
    return same_run(a.spec, b.spec) && a.ok == b.ok && a.reason == b.reason &&
           same_bits(a.outputs, b.outputs) && same_bits(a.diagnostics, b.diagnostics);
}

}  // namespace loam::experiments
