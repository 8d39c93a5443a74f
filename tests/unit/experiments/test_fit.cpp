// The scale on which curves are compared.
#include <gtest/gtest.h>

#include <cmath>

#include "experiments/fit.hpp"

namespace loam::experiments {
namespace {

Observation up_to(double largest) {
    Observation o;
    o.measured = Eigen::Vector3d(0.1 * largest, largest, 0.5 * largest);
    return o;
}

TEST(OutputTransform, ScaleFollowsTheMeasuredCurve) {
    EXPECT_DOUBLE_EQ(transform_for(up_to(0.002)).scale, 1e-3);
    EXPECT_DOUBLE_EQ(transform_for(up_to(0.0159)).scale, 1e-3);
    EXPECT_DOUBLE_EQ(transform_for(up_to(0.0161)).scale, 4e-3);
    EXPECT_DOUBLE_EQ(transform_for(up_to(0.106)).scale, 1.6e-2);
    // Never above a quarter of the largest value, nor sixteen times below it.
    for (double y = 0.005; y < 0.6; y *= 1.1) {
        const double scale = transform_for(up_to(y)).scale;
        EXPECT_LE(4 * scale, y);
        EXPECT_GT(16 * scale, y);
    }
}

TEST(OutputTransform, InverseAndDerivativeBelongToForward) {
    const OutputTransform t{4e-3};
    for (const double y : {0.0, 1e-5, 0.003, 0.2}) {
        EXPECT_NEAR(t.inverse(t.forward(y)), y, 1e-15 + 1e-12 * y);
        const double h = 1e-7;
        EXPECT_NEAR(t.derivative(y), (t.forward(y + h) - t.forward(y - h)) / (2 * h), 1e-5 * t.derivative(y));
    }
    // Linear below the scale: the mean of two collapsed and two standing packings is kept to a tenth.
    const double mean = (0.0004 + 0.0004 + 0.0030 + 0.0034) / 4;
    double sum = 0;
    for (const double y : {0.0004, 0.0004, 0.0030, 0.0034}) sum += t.forward(y) / 4;
    EXPECT_NEAR(t.inverse(sum), mean, 0.15 * mean);
}

}  // namespace
}  // namespace loam::experiments
