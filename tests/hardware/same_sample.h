#pragma once

#include <gtest/gtest.h>

#include "hardware/machine_driver.h"

namespace trueblade {

// To the last bit.
inline void expect_same(const ProbeSample& a, const ProbeSample& b) {
  EXPECT_EQ(a.axes.x_mm, b.axes.x_mm);
  EXPECT_EQ(a.axes.y_mm, b.axes.y_mm);
  EXPECT_EQ(a.axes.z_mm, b.axes.z_mm);
  EXPECT_EQ(a.axes.theta_rad, b.axes.theta_rad);
  EXPECT_EQ(a.distance_mm, b.distance_mm);
  EXPECT_EQ(a.snr, b.snr);
  EXPECT_EQ(a.time_s, b.time_s);
  EXPECT_EQ(a.flags.bits(), b.flags.bits());
}

}  // namespace trueblade
