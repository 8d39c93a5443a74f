#include "lab_data/curve_checks.hpp"

#include <algorithm>
#include <cmath>
#include <iomanip>
#include <numeric>
#include <sstream>

namespace loam::lab_data {
namespace {

constexpr double largest_stress = 1e9;      // Pa
constexpr double least_usual_stress = 1e3;  // Pa: below, the unit is suspect
// Largest shear stress of soils over the pressure on them, beyond which the unit is suspect: cemented ones at
// low pressure reach ten, soft ones some tenths.
constexpr double largest_usual_ratio = 50, least_usual_ratio = 0.02;
constexpr double largest_usual_stress = 1e8;  // Pa, of an oedometer
constexpr double largest_fall =
    0.5;  // of a column that should rise, from one reading to the next, over its range
constexpr double sign_tolerance = 1e-3;  // strain: a first reading may be slightly negative, others fall
constexpr const char* reverse_sign = "compression is positive: reverse the sign of the column";

const std::string& column_name(const Curve& curve, const std::string& quantity) {
    return curve.table.header[curve.columns.at(quantity).index];
}

void check_size(const Curve& curve, const std::string& quantity, double largest,
                const std::string& constraint, const std::string& remedy) {
    const auto& values = curve.values(quantity);
    const auto bad =
        std::ranges::find_if(values, [&](double value) { return !(std::abs(value) <= largest); });
    if (bad == values.end()) return;
    curve.error(static_cast<std::size_t>(bad - values.begin()), quantity, constraint, remedy);
}

void check_sizes(const Curve& curve) {
    const std::string one = "is beyond 1, which no strain can be";
    for (const auto& [quantity, column] : curve.columns) {
        if (column.unit->dimension == Dimension::stress) {
            check_size(curve, quantity, largest_stress, "is beyond 1 GPa",
                       "check the unit in the column's name");
        } else if (quantity.ends_with("strain") && column.unit->suffix.empty()) {
            check_size(curve, quantity, 1, one,
                       "if the column is in percent, name it " + column_name(curve, quantity) + "_percent");
        } else if (quantity.ends_with("strain")) {
            check_size(curve, quantity, 1, "is beyond 100 %, which no strain can be", "correct the values");
        }
    }
}

/// Readings at which a column does not rise though it should, but for noise.
long not_rising(const Curve& curve, const std::string& quantity) {
    const auto& values = curve.values(quantity);
    long count = 0;
    for (std::size_t i = 1; i < values.size(); ++i) {
        const bool should = curve.test.phase.empty() || curve.test.phase[i] != "unloading";
        count += should && values[i] <= values[i - 1];
    }
    return count;
}

/// Falls that noise cannot explain: a column that runs backwards, and, unless the test may be reversed, a
/// reading far below the one before. Whether there are any.
bool find_falls(const Curve& curve, const std::string& quantity, bool may_reverse) {
    const auto& values = curve.values(quantity);
    const auto& phase = curve.test.phase;
    const auto size = static_cast<long>(values.size());
    const double noise = quantity.ends_with("strain") ? sign_tolerance : 0;
    if (phase.empty() && values.back() < values.front() - noise &&
        2 * not_rising(curve, quantity) > size - 1) {
        curve.error(values.size() - 1, quantity, "is below the first reading, as most of the column falls",
                    "put the readings into the order of the test, compression positive");
        return true;
    }
    const auto [least, most] = std::ranges::minmax(values);
    for (std::size_t i = 1; i < values.size() && !may_reverse; ++i) {
        const bool unloads = !phase.empty() && phase[i] == "unloading";
        const double wrong_way = unloads ? values[i] - values[i - 1] : values[i - 1] - values[i];
        if (wrong_way <= std::max(noise, largest_fall * (most - least))) continue;
        curve.error(i, quantity,
                    unloads ? "rises while unloading by more than noise"
                            : "falls from the reading before by more than noise",
                    "correct the value, or leave the reading out");
        return true;
    }
    return false;
}

/// Says what does not rise: as an error where noise cannot be why, else as a warning.
void check_rising(const Curve& curve, const std::string& quantity, bool may_reverse = false) {
    if (find_falls(curve, quantity, may_reverse)) return;
    const long count = not_rising(curve, quantity);
    if (count > 0)
        curve.faults.warn(curve.table.file, std::to_string(count) + " of " +
                                                std::to_string(curve.test.size()) + " readings of " +
                                                quantity + " do not rise; taken as noise");
}

/// Compressed by more than its pores, the specimen's void ratio would be negative.
void check_pores(const Curve& curve, const std::string& quantity) {
    if (!curve.test.initial_void_ratio) return;
    const double start = *curve.test.initial_void_ratio, most = start / (1 + start);
    const auto& values = curve.values(quantity);
    const auto bad = std::ranges::find_if(values, [&](double value) { return value > most; });
    if (bad == values.end()) return;
    std::ostringstream text;
    text << "leaves no pores: an initial void ratio of " << std::setprecision(3) << start
         << " allows a strain of " << most;
    curve.error(static_cast<std::size_t>(bad - values.begin()), quantity, text.str(),
                "check the unit in the column's name, and initial_void_ratio");
}

/// The column must reach a value above zero somewhere.
void check_positive_peak(const Curve& curve, const std::string& quantity, const std::string& remedy) {
    const auto& values = curve.values(quantity);
    const auto peak = std::ranges::max_element(values);
    if (*peak <= 0)
        curve.error(static_cast<std::size_t>(peak - values.begin()), quantity,
                    "is the largest of its column but not positive", remedy);
}

void warn_of_ratio(const Curve& curve, const std::string& quantity, double pressure,
                   const std::string& name) {
    if (pressure <= 0) return;
    const double ratio = std::ranges::max(curve.values(quantity)) / pressure;
    if (ratio <= 0 || (ratio >= least_usual_ratio && ratio <= largest_usual_ratio)) return;
    std::ostringstream text;
    text << column_name(curve, quantity) << " reaches " << std::setprecision(2) << ratio << " times the "
         << name << "; are the units right?";
    curve.faults.warn(curve.table.file, text.str());
}

/// Stresses rise from stage to stage, and fall while unloading. Where a phase changes, the stage may be
/// repeated.
void check_stages(const Curve& curve) {
    const auto& stress = curve.values("axial_stress");
    const auto& phase = curve.test.phase;
    RepeatedFault bad(curve.faults, curve.table.file + ": stages");
    const auto error = [&](std::size_t row, std::string constraint, std::string remedy) {
        Fault fault = curve.table.at(row, curve.columns.at("axial_stress").index);
        fault.constraint = std::move(constraint);
        fault.remedy = std::move(remedy);
        bad.error(fault);
    };
    for (std::size_t i = 0; i < stress.size(); ++i) {
        if (stress[i] <= 0) {
            error(i, "must be above 0",
                  "compression is positive; leave out a reading without load, and state the "
                  "seating_stress_kPa");
        } else if (i == 0) {
            continue;
        } else if (phase.empty() && stress[i] <= stress[i - 1]) {
            error(i, "does not rise above the stress of the reading before",
                  stress[i] < stress[i - 1]
                      ? "put the readings into the order of the test, or add a column phase "
                        "(loading, unloading, reloading) if the specimen was unloaded"
                      : "keep the last reading of each stage");
        } else if (!phase.empty()) {
            const bool falling = phase[i] == "unloading";
            const bool repeated = stress[i] == stress[i - 1];
            if (repeated && phase[i] != phase[i - 1]) continue;
            if (repeated || falling != (stress[i] < stress[i - 1]))
                error(i, falling ? "does not fall while unloading" : "does not rise while " + phase[i],
                      repeated ? "keep the last reading of each stage"
                               : "correct the phase, or the order of the readings");
        }
    }
}

/// Axial strain follows from the void ratio, e = e0 - (1 + e0) strain, which gives away a wrong unit.
void check_void_ratio(const Curve& curve) {
    if (!curve.has("void_ratio")) return;
    const auto& all = curve.values("void_ratio");
    const auto bad = std::ranges::find_if(all, [](double value) { return value <= 0; });
    if (bad != all.end())
        return curve.error(static_cast<std::size_t>(bad - all.begin()), "void_ratio", "must be above 0",
                           "give the volume of pores over that of grains");
    if (!curve.test.initial_void_ratio) return;
    const double start = *curve.test.initial_void_ratio;
    const auto& strain = curve.values("axial_strain");
    const auto& ratio = curve.values("void_ratio");
    std::size_t row = 0;
    const auto expected = [&](std::size_t i) { return (start - ratio[i]) / (1 + start); };
    for (std::size_t i = 1; i < strain.size(); ++i)
        if (std::abs(expected(i)) > std::abs(expected(row))) row = i;
    if (std::abs(expected(row)) < 1e-3) return;
    const double factor = strain[row] / expected(row);
    const std::string name = column_name(curve, "axial_strain");
    if (factor > 50 && factor < 200)
        curve.error(row, "axial_strain", "is a hundred times what the void ratio gives",
                    "if the column is in percent, name it axial_strain_percent");
    else if (factor > 1.0 / 200 && factor < 1.0 / 50)
        curve.error(row, "axial_strain", "is a hundredth of what the void ratio gives",
                    "if the column is a ratio, name it axial_strain");
    else if (std::abs(factor - 1) > 0.2)
        curve.faults.warn(curve.table.file, name + " and void_ratio do not agree with initial_void_ratio");
}

void check_oedometer(const Curve& curve) {
    check_stages(curve);
    const auto& stress = curve.values("axial_stress");
    const auto& strain = curve.values("axial_strain");
    const auto& phase = curve.test.phase;
    if (!phase.empty() && phase.front() != "loading")
        curve.error(0, "phase", "cannot be the first phase", "a test begins with loading");
    if (curve.test.seating_stress && *curve.test.seating_stress > stress.front())
        curve.error(0, "axial_stress", "is below the stated seating stress",
                    "lower seating_stress_kPa or leave the reading out");
    const auto peak = static_cast<std::size_t>(std::ranges::max_element(stress) - stress.begin());
    if (strain[peak] < -sign_tolerance)
        curve.error(peak, "axial_strain", "is negative at the highest stress", reverse_sign);
    else
        check_positive_peak(curve, "axial_strain", "give the strain of each stage, compression positive");
    if (stress[peak] > 0 && stress[peak] < least_usual_stress)
        curve.faults.warn(curve.table.file, "the highest axial stress is below 1 kPa; is the unit right?");
    if (stress[peak] > largest_usual_stress)
        curve.faults.warn(curve.table.file, "the highest axial stress is above 100 MPa; is the unit right?");
    check_void_ratio(curve);
    check_pores(curve, "axial_strain");
    check_rising(curve, "axial_strain");
    const long loading =
        phase.empty() ? static_cast<long>(stress.size()) : std::ranges::count(phase, "loading");
    if (loading < 4)
        curve.faults.warn(curve.table.file,
                          "only " + std::to_string(loading) + " loading stages: little can be fitted");
}

void check_triaxial(const Curve& curve) {
    const auto& axial = curve.values("axial_strain");
    const auto& volumetric = curve.values("volumetric_strain");
    const std::size_t last = axial.size() - 1;
    if (axial[last] < -sign_tolerance)
        curve.error(last, "axial_strain", "is negative at the end of the test", reverse_sign);
    else
        check_positive_peak(curve, "axial_strain", "give the strain of each reading");
    check_positive_peak(curve, "deviatoric_stress", reverse_sign);
    warn_of_ratio(curve, "deviatoric_stress", curve.test.cell_pressure, "cell pressure");
    // Isotropic compression contracts by three times the axial strain; no test of this kind does more.
    if (std::abs(volumetric[last]) > 3 * std::abs(axial[last]) && std::abs(volumetric[last]) > 0.01)
        curve.faults.warn(curve.table.file,
                          "volumetric_strain is more than three times axial_strain; are the units right?");
    check_pores(curve, "volumetric_strain");
    check_rising(curve, "axial_strain");
}

/// What the platen pressed with against what the test says.
void check_normal_stress(const Curve& curve) {
    if (!curve.has("normal_stress") || curve.test.normal_stress <= 0) return;
    const auto& values = curve.values("normal_stress");
    const double mean =
        std::accumulate(values.begin(), values.end(), 0.0) / static_cast<double>(values.size());
    const double ratio = mean / curve.test.normal_stress;
    if (ratio > 0.5 && ratio < 2) return;
    std::ostringstream text;
    text << column_name(curve, "normal_stress") << " is " << std::setprecision(2) << ratio
         << " times the test's normal_stress_kPa; are the units right?";
    curve.faults.warn(curve.table.file, text.str());
}

void check_direct_shear(const Curve& curve) {
    const bool as_strain = curve.has("shear_strain");
    const std::string displacement = as_strain ? "shear_strain" : "shear_displacement";
    const std::string unit_remedy = "check the unit in the column's name and the size of the box";
    if (!as_strain && curve.test.box_length > 0)
        check_size(curve, displacement, curve.test.box_length, "is beyond the box's length", unit_remedy);
    if (!curve.has("settlement_strain") && curve.test.box_height > 0)
        check_size(curve, "settlement", curve.test.box_height, "is beyond the box's height", unit_remedy);
    const std::string forward = "the first direction of shearing is positive: reverse the sign of the column";
    check_positive_peak(curve, displacement, forward);
    check_positive_peak(curve, "shear_stress", forward);
    warn_of_ratio(curve, "shear_stress", curve.test.normal_stress, "normal stress");
    check_normal_stress(curve);
    check_rising(curve, displacement, true);
}

}  // namespace

void Curve::error(std::size_t row, const std::string& quantity, std::string constraint,
                  std::string remedy) const {
    Fault fault = table.at(row, columns.at(quantity).index);
    fault.constraint = std::move(constraint);
    fault.remedy = std::move(remedy);
    faults.error(fault);
}

void check_curve(const Curve& curve) {
    check_sizes(curve);
    switch (curve.test.kind) {
        case TestKind::oedometer:
            return check_oedometer(curve);
        case TestKind::triaxial:
            return check_triaxial(curve);
        case TestKind::direct_shear:
            return check_direct_shear(curve);
    }
}

}  // namespace loam::lab_data
