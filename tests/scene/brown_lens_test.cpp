#include "oraclegs/scene/brown_lens.h"

#include "support/errors.h"

namespace oraclegs {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;

BrownLens PlainLens() { return {6, 4, 5, 5.5, 3, 2}; }

TEST(IntrinsicsOf, ChoosesTheSmallestModel) {
  BrownLens lens = PlainLens();
  EXPECT_EQ(IntrinsicsOf(lens, "x").model, CameraModel::kPinhole);
  lens.p2 = 0.02;
  EXPECT_THAT(IntrinsicsOf(lens, "x").params, ElementsAre(5, 5.5, 3, 2, 0, 0, 0, 0.02));
  lens.k = {0.1, 0.2, 0.3, 0};
  EXPECT_EQ(IntrinsicsOf(lens, "x").model, CameraModel::kFullOpenCv);
  EXPECT_THAT(IntrinsicsOf(lens, "x").params, ElementsAre(5, 5.5, 3, 2, 0.1, 0.2, 0, 0.02, 0.3, 0, 0, 0));
}

TEST(IntrinsicsOf, KnowsFisheyesWithAndWithoutTangentialTerms) {
  BrownLens lens = PlainLens();
  lens.fisheye = true;
  lens.k = {0.1, 0.2, 0.3, 0.4};
  EXPECT_EQ(IntrinsicsOf(lens, "x").model, CameraModel::kOpenCvFisheye);
  EXPECT_THAT(IntrinsicsOf(lens, "x").params, ElementsAre(5, 5.5, 3, 2, 0.1, 0.2, 0.3, 0.4));
  lens.p1 = 0.01;
  EXPECT_EQ(IntrinsicsOf(lens, "x").model, CameraModel::kThinPrismFisheye);
  EXPECT_THAT(IntrinsicsOf(lens, "x").params, ElementsAre(5, 5.5, 3, 2, 0.1, 0.2, 0.01, 0, 0.3, 0.4, 0, 0));
}

TEST(IntrinsicsOf, RefusesAFourthCoefficientAndBadNumbers) {
  BrownLens lens = PlainLens();
  lens.k[3] = 0.1;
  EXPECT_THAT(MessageOf<InputError>([&] { IntrinsicsOf(lens, "FILE"); }), HasSubstr("FILE: \"k4\""));
  lens = PlainLens();
  lens.fx = 0;
  EXPECT_THAT(MessageOf<InputError>([&] { IntrinsicsOf(lens, "FILE"); }), HasSubstr("FILE"));
}

}  // namespace
}  // namespace oraclegs
