#include "oraclegs/formats/values.h"

#include <limits>

#include "formats/splats.h"

namespace oraclegs {
namespace {

TEST(NearestByte, RoundsAndStopsAtTheEnds) {
  EXPECT_EQ(NearestByte(-3), 0);
  EXPECT_EQ(NearestByte(0.5f), 1);
  EXPECT_EQ(NearestByte(254.4f), 254);
  EXPECT_EQ(NearestByte(1e9f), 255);
  EXPECT_EQ(NearestByte(std::numeric_limits<float>::quiet_NaN()), 0);
}

TEST(LogitOfOpacity, IsTheInverseOfTheSigmoid) {
  EXPECT_NEAR(Sigmoid(LogitOfOpacity(0.3f)), 0.3f, 1e-6);
  EXPECT_EQ(LogitOfOpacity(0), -15);
  EXPECT_EQ(LogitOfOpacity(1), 15);
}

TEST(UnitQuaternion, HasLengthOneForTinyAndHugeOnes) {
  const float tiny[] = {0, 3e-30f, 4e-30f, 0}, huge[] = {3e30f, 0, 0, 4e30f}, none[] = {0, 0, 0, 0};
  EXPECT_NEAR(UnitQuaternion(tiny)[2], 0.8f, 1e-6);
  EXPECT_NEAR(UnitQuaternion(huge)[3], 0.8f, 1e-6);
  EXPECT_EQ(UnitQuaternion(none), (std::array<float, 4>{1, 0, 0, 0}));
}

TEST(SmallestThree, RestoresTheRotation) {
  const Buffer<float> random = RandomNormal({50, 4}, 1);
  for (int64_t i = 0; i < 50; ++i) {
    const auto q = UnitQuaternion(random.data() + 4 * i);
    const SmallestThree rotation = DropLargest(q);
    const auto restored = RestoreLargest(rotation);
    const float sign = q[rotation.largest] < 0 ? -1.f : 1.f;
    for (int c = 0; c < 4; ++c) EXPECT_NEAR(restored[c], sign * q[c], 1e-6);
  }
}

TEST(TurnHalf, IsItsOwnInverseAndTurnsWhatItShould) {
  const Gaussians original = PlausibleGaussians(5);
  const Gaussians turned = original.Clone();
  for (int64_t i = 0; i < 5; ++i) TurnHalf(turned.Rows().From(i), kTurnAboutX);
  EXPECT_EQ(turned.means[0], original.means[0]);
  EXPECT_EQ(turned.means[1], -original.means[1]);
  EXPECT_EQ(turned.means[2], -original.means[2]);
  EXPECT_EQ(turned.sh[2], original.sh[2]);   // constant
  EXPECT_EQ(turned.sh[3], -original.sh[3]);  // odd in y
  EXPECT_EQ(turned.sh[9], original.sh[9]);   // odd in x
  for (int64_t i = 0; i < 5; ++i) TurnHalf(turned.Rows().From(i), kTurnAboutX);
  EXPECT_TRUE(SameBytes(turned.quats, original.quats));
  EXPECT_TRUE(SameBytes(turned.sh, original.sh));
}

TEST(HostCopy, ClearsHarmonicsAboveTheDegree) {
  const Gaussians original = PlausibleGaussians(3);
  const Gaussians copy = HostCopy(original, 1);
  EXPECT_EQ(copy.sh[11], original.sh[11]);
  EXPECT_EQ(copy.sh[12], 0);
  EXPECT_NE(original.sh[12], 0);
}

TEST(WithoutDamaged, NamesTheGaussian) {
  GaussianPly splat{PlausibleGaussians(3)};
  EXPECT_EQ(WithoutDamaged(splat, "a.spz").gaussians.size(), 3);
  splat.gaussians.means[7] = std::numeric_limits<float>::infinity();
  const std::string message = MessageOf<InputError>([&] { WithoutDamaged(splat, "a.spz"); });
  EXPECT_THAT(message, testing::HasSubstr("a.spz: 1 of 3 Gaussians"));
  EXPECT_THAT(message, testing::HasSubstr("y of Gaussian 2 is inf"));
}

TEST(DeviationOf, StaysWithinFloats) {
  for (const float log : {-1e30f, -69.f, 0.f, 88.f, 1e30f}) {
    EXPECT_TRUE(std::isnormal(DeviationOf(log))) << log;
    EXPECT_TRUE(std::isfinite(LogOfDeviation(DeviationOf(log)))) << log;
  }
  EXPECT_NEAR(LogOfDeviation(DeviationOf(-3)), -3, 1e-6);
  EXPECT_NEAR(LogOfDeviation(0), std::log(1e-30), 1e-4);
  EXPECT_TRUE(std::isnan(LogOfDeviation(-1)));
}

TEST(ZeroSplat, RefusesAnEmptyFile) {
  EXPECT_THAT(MessageOf<InputError>([] { ZeroSplat(0, 1, "a.spz"); }), testing::HasSubstr("holds no Gaussians"));
}

}  // namespace
}  // namespace oraclegs
