#include "experiments/bulk/fit_journal.hpp"

#include <fcntl.h>
#include <unistd.h>

#include <cerrno>
#include <nlohmann/json.hpp>

#include "experiments/output/atomic_file.hpp"
#include "experiments/output/json_values.hpp"
#include "experiments/output/storage_error.hpp"

namespace loam::experiments {
namespace {

using Eigen::Index;
using Eigen::VectorXd;
using nlohmann::json;

VectorXd vector_of(const json& list) {
    const auto values = list.get<std::vector<double>>();
    return Eigen::Map<const VectorXd>(values.data(), static_cast<Index>(values.size()));
}

std::string line_of(const FittedSample& fit) {
    json entry{{"row", fit.row},
               {"estimate", values_of(fit.estimate)},
               {"q05", values_of(fit.quantiles.col(0))},
               {"q50", values_of(fit.quantiles.col(1))},
               {"q95", values_of(fit.quantiles.col(2))},
               {"misfit", fit.misfit},
               {"effective", fit.effective},
               {"emulator_share", fit.emulator_share},
               {"predicted", values_of(fit.predicted)}};
    return entry.dump() + "\n";
}

FittedSample fit_of(const json& entry) {
    FittedSample fit;
    fit.row = entry.at("row").get<std::size_t>();
    fit.estimate = vector_of(entry.at("estimate"));
    fit.quantiles.resize(fit.estimate.size(), 3);
    fit.quantiles << vector_of(entry.at("q05")), vector_of(entry.at("q50")), vector_of(entry.at("q95"));
    fit.misfit = entry.at("misfit").get<double>();
    fit.effective = entry.at("effective").get<double>();
    fit.emulator_share = entry.at("emulator_share").get<double>();
    fit.predicted = vector_of(entry.at("predicted"));
    return fit;
}

}  // namespace

FitJournal::FitJournal(const std::filesystem::path& path) : path_(path) {
    const std::string text = read_file_if_there(path).value_or("");
    std::size_t sound = 0;  // bytes
    for (std::size_t end; (end = text.find('\n', sound)) != std::string::npos; sound = end + 1) {
        const json entry = json::parse(text.substr(sound, end - sound), nullptr, /*allow_exceptions=*/false);
        if (entry.is_discarded()) break;
        FittedSample fit = fit_of(entry);
        found_.insert_or_assign(fit.row, std::move(fit));
    }
    if (sound < text.size()) write_file_atomically(path, text.substr(0, sound));
    file_ = open_file(path, O_WRONLY | O_CREAT | O_APPEND);
    if (!file_) throw_write_error(path, errno);
}

void FitJournal::append(const FittedSample& fit) {
    const std::string line = line_of(fit);
    const std::scoped_lock lock(mutex_);
    if (const int error = write_all(file_.get(), line); error != 0) throw_write_error(path_, error);
    if (::fdatasync(file_.get()) != 0) throw_write_error(path_, errno);
}

}  // namespace loam::experiments
