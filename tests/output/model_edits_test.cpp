#include "oraclegs/output/model_edits.h"

#include <gmock/gmock.h>

#include "support/buffers.h"
#include "support/errors.h"

namespace oraclegs {
namespace {

using testing::HasSubstr;

TEST(Crop, BoxHoldsWhatLiesBetweenItsCorners) {
  const Crop crop = ParseCrop("box:1,0,0,-1,2,0.5");
  EXPECT_TRUE(crop.Holds({0, 1, 0.25}));
  EXPECT_TRUE(crop.Holds({1, 2, 0.5}));
  EXPECT_FALSE(crop.Holds({0, -0.1, 0.25}));
  EXPECT_FALSE(crop.Holds({1.1, 1, 0.25}));
}

TEST(Crop, SphereHoldsWhatLiesWithinItsRadius) {
  const Crop crop = ParseCrop("sphere:1,-2,3e0,0.5");
  EXPECT_TRUE(crop.Holds({1, -2, 3.4}));
  EXPECT_FALSE(crop.Holds({1, -2, 3.6}));
}

TEST(Crop, NoneHoldsAll) { EXPECT_TRUE(ParseCrop("").Holds({1e9, 0, 0})); }

TEST(Crop, RefusesAnotherForm) {
  EXPECT_EQ(ParseCrop("auto").kind, Crop::Kind::kAuto);
  for (const char* text : {"box", "box:", "box:1,2,3", "box:1,2,3,4,5,x", "box:1,2,3,4,5,6,", "sphere:0,0,0,0",
                           "sphere:0,0,0,-1", "sphere:0,0,nan,1", "sphere:0,0,inf,1", "ball:0,0,0,1", "autom", ":"}) {
    EXPECT_THAT(MessageOf<UsageError>([&] { ParseCrop(text); }), HasSubstr("must be auto, box:")) << text;
  }
}

TEST(Crop, HoldsGaussiansInItsCoordinates) {
  Gaussians g = Gaussians::Zeros(3);
  g.means[0] = 1, g.means[3] = 2, g.means[6] = 3;
  EXPECT_THAT(HeldBy(ParseCrop("box:1.5,-1,-1,3.5,1,1"), g, {}), testing::ElementsAre(1, 2));
  Similarity twice;
  twice.scale = 2;
  EXPECT_THAT(HeldBy(ParseCrop("box:1.5,-1,-1,3.5,1,1"), g, twice), testing::ElementsAre(0));
  EXPECT_THAT(HeldBy(ParseCrop("sphere:9,9,9,1"), g, {}), testing::IsEmpty());
}

TEST(Axis, IsAUnitVector) {
  EXPECT_FALSE(ParseAxis("").has_value());
  EXPECT_FALSE(ParseAxis("auto").has_value());
  EXPECT_EQ(*ParseAxis("y"), Eigen::Vector3d(0, 1, 0));
  EXPECT_EQ(*ParseAxis("-z"), Eigen::Vector3d(0, 0, -1));
  for (const char* text : {"w", "-", "xy", "--x", "+x"}) {
    EXPECT_THAT(MessageOf<UsageError>([&] { ParseAxis(text); }), HasSubstr("-z")) << text;
  }
}

TEST(OutlierGaussians, AreSmallAndFarFromAllOthers) {
  Gaussians g = Gaussians::Zeros(1003);
  Flat(g.means) = Flat(RandomNormal({1003, 3}, 1));
  Flat(g.log_scales) = -4;
  for (int c = 0; c < 3; ++c) {
    g.means[c] = 100;      // small: outlier
    g.means[3 + c] = -80;  // as large as its distance: background
    g.log_scales[3 + c] = 5;
  }
  const std::vector<bool> outlier = OutlierGaussians(g);
  EXPECT_TRUE(outlier[0]);
  EXPECT_FALSE(outlier[1]);
  EXPECT_LT(std::count(outlier.begin(), outlier.end(), true), 20);
}

TEST(OutlierGaussians, AreNoneAmongFewOrEven) {
  EXPECT_THAT(OutlierGaussians(Gaussians::Zeros(1)), testing::ElementsAre(false));
  EXPECT_THAT(OutlierGaussians(Gaussians::Zeros(3)), testing::Each(false));
  Gaussians row = Gaussians::Zeros(50);
  Flat(row.log_scales) = -9;
  for (int i = 0; i < 50; ++i) row.means[3 * i] = static_cast<float>(i);
  EXPECT_THAT(OutlierGaussians(row), testing::Each(false));
}

TEST(TurnBetween, TakesOneDirectionToTheOther) {
  const Eigen::Vector3d a = Eigen::Vector3d(1, 2, 3).normalized(), b(0, -1, 0);
  EXPECT_LT((TurnBetween(a, b) * a - b).norm(), 1e-9);
  EXPECT_LT((TurnBetween(b, -b) * b + b).norm(), 1e-9);  // opposite
  EXPECT_NEAR(TurnBetween(b, -b).determinant(), 1, 1e-9);
}

}  // namespace
}  // namespace oraclegs
