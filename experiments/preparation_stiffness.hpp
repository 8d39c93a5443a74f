// How stiff the particles are that specimens are made of.
#pragma once

namespace loam::experiments {

/// Modulus of the particles that specimens are made of, over the stress; where a test's own are stiffer, its
/// seating begins with this over the seating stress. What soft particles overlap goes into rebound when
/// stiffer ones take their place, and contacts open: made at 2,000 instead of 20,000, a dense specimen gives
/// half as much oedometer strain again at 15 kPa and a tenth more at 1 MPa; 50,000 gives the same. Seated at
/// 2,000, a loose specimen gives 1.6 times the strain at 15 kPa.
constexpr double preparation_stiffness = 20'000;

}  // namespace loam::experiments
