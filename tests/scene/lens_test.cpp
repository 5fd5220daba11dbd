#include "oraclegs/scene/lens.h"

#include <limits>

#include "scene/tiny_scenes.h"

namespace oraclegs {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;

TEST(LensModel, NamesIdsAndCountsAreColmaps) {
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
    const auto model = LensModelFromId(row.id);
    ASSERT_TRUE(model.has_value());
    EXPECT_EQ(static_cast<int>(*model), row.id);
    EXPECT_EQ(LensModelFromName(row.name), model);
    EXPECT_EQ(LensModelName(*model), row.name);
    EXPECT_EQ(LensParameterCount(*model), row.count);
  }
  EXPECT_FALSE(LensModelFromId(11).has_value());
  EXPECT_FALSE(LensModelFromId(-1).has_value());
  EXPECT_FALSE(LensModelFromName("PINHOLE ").has_value());
  EXPECT_FALSE(LensModelFromName("").has_value());
}

TEST(Lens, AccessorsFollowTheParameterOrder) {
  const Lens one{LensModel::kSimpleRadial, 60, 40, {50, 30, 20, 0.1}};
  EXPECT_THAT((std::vector{one.fx(), one.fy(), one.cx(), one.cy()}), ElementsAre(50, 50, 30, 20));
  const Lens two{LensModel::kFov, 60, 40, {50, 51, 30, 20, 0.9}};
  EXPECT_THAT((std::vector{two.fx(), two.fy(), two.cx(), two.cy()}), ElementsAre(50, 51, 30, 20));
}

TEST(Lens, IsPinholeLooksAtTheCoefficients) {
  EXPECT_TRUE((Lens{LensModel::kSimplePinhole, 60, 40, {50, 30, 20}}.IsPinhole()));
  EXPECT_TRUE((Lens{LensModel::kOpenCv, 60, 40, {50, 50, 30, 20, 0, 0, 0, 0}}.IsPinhole()));
  EXPECT_TRUE((Lens{LensModel::kFov, 60, 40, {50, 50, 30, 20, 0}}.IsPinhole()));
  EXPECT_FALSE((Lens{LensModel::kOpenCv, 60, 40, {50, 50, 30, 20, 0, 0, 0, 1e-6}}.IsPinhole()));
  EXPECT_FALSE((Lens{LensModel::kSimpleRadial, 60, 40, {50, 30, 20, 0.1}}.IsPinhole()));
  EXPECT_FALSE((Lens{LensModel::kOpenCvFisheye, 60, 40, {50, 50, 30, 20, 0, 0, 0, 0}}.IsPinhole()));
}

TEST(Lens, CheckNamesWhatIsWrong) {
  const Lens good{LensModel::kSimpleRadial, 60, 40, {50, 30, 20, 0.1}};
  EXPECT_NO_THROW(good.Check("cameras.txt"));
  const auto message = [&good](auto change) {
    Lens lens = good;
    change(&lens);
    return InputErrorOf([&] { lens.Check("cameras.txt: camera 3"); });
  };
  EXPECT_THAT(message([](Lens* l) { l->params.pop_back(); }),
              HasSubstr("cameras.txt: camera 3: a SIMPLE_RADIAL lens has 4 parameters, found 3"));
  EXPECT_THAT(message([](Lens* l) { l->params.clear(); }), HasSubstr("found 0"));
  EXPECT_THAT(message([](Lens* l) { l->params[3] = std::nan(""); }), HasSubstr("not finite"));
  EXPECT_THAT(message([](Lens* l) { l->params[0] = 0; }), HasSubstr("focal length is 0 x 0"));
  EXPECT_THAT(message([](Lens* l) { l->height = -1; }), HasSubstr("60 x -1"));
}

TEST(Lens, ResizedMovesEveryPixelInProportion) {
  const Lens lenses[] = {
      {LensModel::kSimplePinhole, 60, 40, {50, 30, 20}},
      {LensModel::kSimpleRadial, 60, 40, {50, 30, 20, -0.1}},
      {LensModel::kRadial, 60, 40, {50, 30, 20, -0.1, 0.02}},
      {LensModel::kSimpleRadialFisheye, 60, 40, {50, 30, 20, -0.1}},
      {LensModel::kRadialFisheye, 60, 40, {50, 30, 20, -0.1, 0.02}},
      {LensModel::kThinPrismFisheye, 60, 40, {50, 52, 30, 20, 0.1, 0, 0.01, 0.02, 0, 0, 0.01, 0}},
      {LensModel::kFov, 60, 40, {50, 52, 30, 20, 0.8}},
  };
  for (const Lens& lens : lenses) {
    const Lens small = Resized(lens, 30, 13);
    EXPECT_NO_THROW(small.Check("small"));
    EXPECT_EQ(small.width, 30);
    EXPECT_EQ(small.height, 13);
    const auto pixel = lens.Project(0.3, -0.2), small_pixel = small.Project(0.3, -0.2);
    ASSERT_TRUE(pixel && small_pixel) << LensModelName(lens.model);
    EXPECT_NEAR(small_pixel->x(), pixel->x() / 2, 1e-12) << LensModelName(lens.model);
    EXPECT_NEAR(small_pixel->y(), pixel->y() * 13 / 40, 1e-12) << LensModelName(lens.model);
  }
}

}  // namespace
}  // namespace oraclegs
