#include "oraclegs/gaussians/damaged_rows.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "support/buffers.h"
#include "support/errors.h"

namespace oraclegs {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;

constexpr float kInfinite = std::numeric_limits<float>::infinity();

Gaussians Numbered(int64_t n) {
  Gaussians g = Gaussians::Zeros(n);
  for (int64_t i = 0; i < n; ++i) {
    g.means[3 * i] = static_cast<float>(i);
    g.quats[4 * i] = 1;
  }
  return g;
}

struct Repaired {
  explicit Repaired(Gaussians given)
      : gaussians(std::move(given)), marks{std::vector<float>(static_cast<size_t>(gaussians.size()), 0.5f)} {
    LeaveOutDamaged("a.ply", &gaussians, &marks, &warnings);
  }

  Gaussians gaussians;
  GaussianMarks marks;
  std::vector<std::string> warnings;
};

TEST(LeaveOutDamaged, KeepsEveryNumberOfWholeRows) {
  const Gaussians g = Numbered(10);
  const Repaired repaired(g.Clone());
  EXPECT_TRUE(SameBytes(repaired.gaussians.means, g.means));
  EXPECT_TRUE(SameBytes(repaired.gaussians.quats, g.quats));
  EXPECT_TRUE(repaired.warnings.empty());
}

TEST(LeaveOutDamaged, LeavesOutOneInTen) {
  Gaussians g = Numbered(20);
  g.sh[3 * kShFloats + 40] = kInfinite;
  g.means[3 * 7 + 2] = NAN;
  const Repaired repaired(g);
  EXPECT_EQ(repaired.gaussians.size(), 18);
  EXPECT_EQ(repaired.marks.support.size(), 18u);
  EXPECT_EQ(repaired.gaussians.means[3 * 3], 4);
  EXPECT_THAT(repaired.warnings, ElementsAre(HasSubstr("a.ply: 2 of 20 Gaussians")));
  EXPECT_THAT(repaired.warnings[0], HasSubstr("f_rest_37 of Gaussian 3 is inf"));
}

TEST(LeaveOutDamaged, RefusesMore) {
  Gaussians g = Numbered(19);
  g.opacity_logits[3] = NAN, g.log_scales[12] = kInfinite;
  const std::string message = MessageOf<InputError>([&] { Repaired{g}; });
  EXPECT_THAT(message, HasSubstr("a.ply: 2 of 19 Gaussians"));
  EXPECT_THAT(message, HasSubstr("opacity of Gaussian 3 is nan"));
}

TEST(LeaveOutDamaged, TakesARotationOfZerosForNone) {
  Gaussians g = Numbered(3);
  g.quats[4] = 0;
  const Repaired repaired(g);
  EXPECT_EQ(repaired.gaussians.quats[4], 1);
  EXPECT_THAT(repaired.warnings, ElementsAre(HasSubstr("1 of 3 Gaussians have a rotation of zeros")));
}

TEST(LeaveOutDamaged, GivesRotationsALengthThatFloatsHold) {
  Gaussians g = Numbered(2);
  g.quats[0] = g.quats[1] = 3e38f;
  g.quats[6] = std::numeric_limits<float>::denorm_min();
  const Repaired repaired(g);
  EXPECT_NEAR(repaired.gaussians.quats[0], std::sqrt(0.5), 1e-6);
  EXPECT_NEAR(repaired.gaussians.quats[1], std::sqrt(0.5), 1e-6);
  EXPECT_TRUE(repaired.warnings.empty());
}

TEST(LeaveOutDamaged, KeepsOpacitiesOfZeroAndOneAndFlatGaussians) {
  Gaussians g = Numbered(2);
  g.opacity_logits[0] = kInfinite, g.opacity_logits[1] = -kInfinite;
  g.log_scales[4] = -kInfinite;
  const Repaired repaired(g);
  EXPECT_THAT(repaired.gaussians.opacity_logits.span(), ElementsAre(15, -15));
  EXPECT_NEAR(repaired.gaussians.log_scales[4], std::log(1e-30), 1e-4);
  EXPECT_TRUE(repaired.warnings.empty());
}

}  // namespace
}  // namespace oraclegs
