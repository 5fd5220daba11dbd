#include "oraclegs/camera/intrinsics.h"

#include <cmath>
#include <limits>

#include "oraclegs/camera/distortion_models.h"
#include "support/errors.h"

namespace oraclegs {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;

TEST(CameraModel, HasColmapsNamesIdsAndCounts) {
  struct Row {
    int id;
    const char* name;
    int count;
  };
  const Row rows[] = {{0, "SIMPLE_PINHOLE", 3},
                      {1, "PINHOLE", 4},
                      {2, "SIMPLE_RADIAL", 4},
                      {3, "RADIAL", 5},
                      {4, "OPENCV", 8},
                      {5, "OPENCV_FISHEYE", 8},
                      {6, "FULL_OPENCV", 12},
                      {7, "FOV", 5},
                      {8, "SIMPLE_RADIAL_FISHEYE", 4},
                      {9, "RADIAL_FISHEYE", 5},
                      {10, "THIN_PRISM_FISHEYE", 12}};
  for (const Row& row : rows) {
    const auto model = CameraModelFromId(row.id);
    ASSERT_TRUE(model.has_value());
    EXPECT_EQ(static_cast<int>(*model), row.id);
    EXPECT_EQ(CameraModelFromName(row.name), model);
    EXPECT_EQ(CameraModelName(*model), row.name);
    EXPECT_EQ(CameraModelParameterCount(*model), row.count);
  }
  EXPECT_FALSE(CameraModelFromId(11).has_value());
  EXPECT_FALSE(CameraModelFromId(-1).has_value());
  EXPECT_FALSE(CameraModelFromName("PINHOLE ").has_value());
  EXPECT_FALSE(CameraModelFromName("").has_value());
}

TEST(Intrinsics, ReadsParametersInColmapsOrder) {
  const Intrinsics one{CameraModel::kSimpleRadial, 60, 40, {50, 30, 20, 0.1}};
  EXPECT_THAT((std::vector{one.fx(), one.fy(), one.cx(), one.cy()}), ElementsAre(50, 50, 30, 20));
  const Intrinsics two{CameraModel::kFov, 60, 40, {50, 51, 30, 20, 0.9}};
  EXPECT_THAT((std::vector{two.fx(), two.fy(), two.cx(), two.cy()}), ElementsAre(50, 51, 30, 20));
}

TEST(Intrinsics, IsPinholeWithoutDistortion) {
  EXPECT_TRUE((Intrinsics{CameraModel::kSimplePinhole, 60, 40, {50, 30, 20}}.IsPinhole()));
  EXPECT_TRUE((Intrinsics{CameraModel::kOpenCv, 60, 40, {50, 50, 30, 20, 0, 0, 0, 0}}.IsPinhole()));
  EXPECT_TRUE((Intrinsics{CameraModel::kFov, 60, 40, {50, 50, 30, 20, 0}}.IsPinhole()));
  EXPECT_FALSE((Intrinsics{CameraModel::kOpenCv, 60, 40, {50, 50, 30, 20, 0, 0, 0, 1e-6}}.IsPinhole()));
  EXPECT_FALSE((Intrinsics{CameraModel::kSimpleRadial, 60, 40, {50, 30, 20, 0.1}}.IsPinhole()));
  EXPECT_FALSE((Intrinsics{CameraModel::kOpenCvFisheye, 60, 40, {50, 50, 30, 20, 0, 0, 0, 0}}.IsPinhole()));
}

TEST(Intrinsics, CheckNamesTheFault) {
  const Intrinsics good{CameraModel::kSimpleRadial, 60, 40, {50, 30, 20, 0.1}};
  EXPECT_NO_THROW(good.Check("cameras.txt"));
  const auto message = [&good](auto change) {
    Intrinsics intrinsics = good;
    change(&intrinsics);
    return MessageOf<InputError>([&] { intrinsics.Check("cameras.txt: camera 3"); });
  };
  EXPECT_THAT(message([](Intrinsics* i) { i->params.pop_back(); }),
              HasSubstr("cameras.txt: camera 3: camera model SIMPLE_RADIAL has 4 parameters, found 3"));
  EXPECT_THAT(message([](Intrinsics* i) { i->params.clear(); }), HasSubstr("found 0"));
  EXPECT_THAT(message([](Intrinsics* i) { i->params[3] = std::nan(""); }), HasSubstr("not finite"));
  EXPECT_THAT(message([](Intrinsics* i) { i->params[0] = 0; }), HasSubstr("focal length is 0 x 0"));
  EXPECT_THAT(message([](Intrinsics* i) { i->height = -1; }), HasSubstr("60 x -1"));
}

TEST(Intrinsics, ResizesEveryPixelInProportion) {
  const Intrinsics cameras[] = {
      {CameraModel::kSimplePinhole, 60, 40, {50, 30, 20}},
      {CameraModel::kSimpleRadial, 60, 40, {50, 30, 20, -0.1}},
      {CameraModel::kRadial, 60, 40, {50, 30, 20, -0.1, 0.02}},
      {CameraModel::kSimpleRadialFisheye, 60, 40, {50, 30, 20, -0.1}},
      {CameraModel::kRadialFisheye, 60, 40, {50, 30, 20, -0.1, 0.02}},
      {CameraModel::kThinPrismFisheye, 60, 40, {50, 52, 30, 20, 0.1, 0, 0.01, 0.02, 0, 0, 0.01, 0}},
      {CameraModel::kFov, 60, 40, {50, 52, 30, 20, 0.8}},
  };
  for (const Intrinsics& intrinsics : cameras) {
    const Intrinsics small = Resized(intrinsics, 30, 13);
    EXPECT_NO_THROW(small.Check("small"));
    EXPECT_EQ(small.width, 30);
    EXPECT_EQ(small.height, 13);
    const auto pixel = Project(intrinsics, 0.3, -0.2), small_pixel = Project(small, 0.3, -0.2);
    ASSERT_TRUE(pixel && small_pixel) << CameraModelName(intrinsics.model);
    EXPECT_NEAR(small_pixel->x(), pixel->x() / 2, 1e-12) << CameraModelName(intrinsics.model);
    EXPECT_NEAR(small_pixel->y(), pixel->y() * 13 / 40, 1e-12) << CameraModelName(intrinsics.model);
  }
}

}  // namespace
}  // namespace oraclegs
