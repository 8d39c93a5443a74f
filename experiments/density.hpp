// How dense a specimen is made: at the void ratio that was measured, or at its relative density.
#pragma once

#include <optional>

#include "experiments/settings/settings.hpp"
#include "lab_data/sample.hpp"

namespace loam::experiments {

/// Void ratios at which a material is as dense, and as loose, as it gets.
struct LimitVoidRatios {
    double least = 0, greatest = 0;
};

/// Of spheres with radii uniform within 1 +- spread, between measurements at spreads of 0, 0.3 and 0.6: the
/// densest as the packing generator makes them (three packings of 1,500, scatter 0.003); the loosest by
/// compaction of a cloud as dense as random addition fills it, at a friction of 1.2 rad. Out of a gas the
/// generator makes still looser ones, up to 1.4, which no grains keep that can roll.
LimitVoidRatios limits_of_spheres(double spread);

/// Of the soil: its properties minimum_void_ratio and maximum_void_ratio; else from the median grain size of
/// its grading by the correlations for sands and gravels of Cubrinovski and Ishihara (1999, 2002):
/// e_max - e_min = 0.23 + 0.06 mm / d50 and e_max = 0.072 + 1.53 e_min. Throws UserError where neither is
/// stated, or the limits are not in order.
LimitVoidRatios limits_of_soil(const lab_data::Sample& sample);

/// Grain size below which half of the mass lies (m), logarithmic between sieves; 0 where no grading is stated
/// or it does not reach half.
double median_grain_size(const lab_data::Sample& sample);

/// Half the width of the grading over its middle, (d_max - d_min) / (d_max + d_min), where the largest grains
/// are at most three times the smallest, so that spheres of all sizes can be simulated; none where it is
/// wider or not stated from end to end (0.5 % by mass). Packings of one void ratio are the denser for what
/// they can be, the narrower the grading: at +- 20 % instead of 30 % an oedometer gives a tenth less strain.
std::optional<double> spread_of_grading(const lab_data::Sample& sample);

/// Axial strain of a direct shear test's specimen under its normal stress, before it is sheared, as the
/// sample's own oedometer test tells: of the loading whose initial void ratio is nearest, linear between its
/// readings and constant beyond. 0 for other tests, and where no oedometer test has a void ratio within 0.15
/// or the strain is above 0.05, a collapse that a denser box does not share.
double strain_before_shearing(const lab_data::Sample& sample, const lab_data::Test& test);

/// Porosity at which the test's specimen is made: the setting's; else, from the measured initial void ratio,
/// the same or that of the same relative density (settings.specimen.match); else the 0.47 of De Pue et al.
/// (2019). A direct shear test's void ratio, like its box's height, is that at the start of shearing: the
/// specimen is made looser by strain_before_shearing. Throws UserError as limits_of_soil.
double target_porosity(const Settings& settings, const lab_data::Sample& sample, const lab_data::Test& test);

}  // namespace loam::experiments
