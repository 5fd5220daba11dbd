#include "oraclegs/sfm/colmap_quality.h"

#include <cmath>

#include "scene/tiny_scenes.h"
#include "support/errors.h"
#include "support/temp_dir.h"

namespace oraclegs {
namespace {

const Intrinsics kLens{CameraModel::kSimpleRadial, 1000, 800, {900, 500, 400, 0}};

ColmapImage ImageAt(uint32_t id, double x) {
  ColmapImage image{id, std::to_string(id) + ".png", 1};
  image.cam_from_world.translation() = Eigen::Vector3d(-x, 0, 0);
  return image;
}

ColmapPoint PointAt(const Eigen::Vector3d& xyz, std::vector<uint32_t> seen_by, double error = .5) {
  ColmapPoint point;
  point.xyz = xyz;
  point.image_ids = std::move(seen_by);
  point.reprojection_error = error;
  return point;
}

/// A model by its numbers alone.
ModelQuality Quality(int registered, int points, double error = .5, double parallax = 5) {
  ModelQuality model;
  for (int i = 0; i < registered; ++i) model.images[std::to_string(i)] = {};
  model.points = points;
  model.reprojection_error = error;
  model.parallax_degrees = parallax;
  return model;
}

TEST(MeasureModel, MeasuresParallaxPerImageAndOverall) {
  // From x = 0 and 1 a point one ahead of the first is seen under 45 degrees; from x = 0 and tan(60) under 60.
  const ModelQuality model =
      MeasureModel({{1, kLens}}, {ImageAt(1, 0), ImageAt(2, 1), ImageAt(3, std::sqrt(3.)), ImageAt(4, 9)},
                   {PointAt({0, 0, 1}, {1, 2}, .2), PointAt({0, 0, 1}, {3, 1, 3}, .4), PointAt({0, 0, 5}, {2, 2}),
                    PointAt({0, 0, 5}, {77, 2})});
  EXPECT_EQ(model.registered(), 4);
  EXPECT_EQ(model.points, 2) << "a point is seen twice, from different images of the model";
  EXPECT_NEAR(model.reprojection_error, .3, 1e-12);
  EXPECT_NEAR(model.images.at("2.png").parallax_degrees, 45, 1e-9);
  EXPECT_NEAR(model.images.at("3.png").parallax_degrees, 60, 1e-9);
  EXPECT_NEAR(model.images.at("2.png").nearest_degrees, 45, 1e-9);
  EXPECT_EQ(model.images.at("1.png").points, 2);
  EXPECT_EQ(model.images.at("4.png").points, 0);
  EXPECT_EQ(model.images.at("4.png").parallax_degrees, 0);
  EXPECT_TRUE(model.plausible_intrinsics);
}

TEST(MeasureModel, DetectsImplausibleIntrinsics) {
  const std::vector<ColmapImage> images{ImageAt(1, 0), ImageAt(2, 1)};
  for (const std::vector<double>& params :
       {std::vector<double>{14133, 500, 400, 0}, {300, 500, 400, 0}, {900, 500, 400, 20}}) {
    EXPECT_FALSE(MeasureModel({{1, {CameraModel::kSimpleRadial, 1000, 800, params}}}, images, {}).plausible_intrinsics);
  }
  EXPECT_FALSE(MeasureModel({{2, kLens}}, images, {}).plausible_intrinsics) << "camera 1 is missing";
}

TEST(HasPlausiblePart, NamesTheImagesOfAnImplausibleCamera) {
  ColmapImage odd = ImageAt(4, 3);
  odd.camera_id = 2;
  const Intrinsics far{CameraModel::kSimpleRadial, 800, 1000, {7051, 400, 500, -19}};
  const ModelQuality model =
      MeasureModel({{1, kLens}, {2, far}}, {ImageAt(1, 0), ImageAt(2, 1), ImageAt(3, 2), odd}, {});
  EXPECT_EQ(model.implausible_images, std::vector<std::string>{"4.png"});
  EXPECT_TRUE(HasPlausiblePart(model));
  EXPECT_FALSE(HasPlausiblePart(MeasureModel({{1, kLens}, {2, far}}, {ImageAt(1, 0), odd}, {}))) << "one is left";
  EXPECT_FALSE(HasPlausiblePart(MeasureModel({{1, kLens}}, {ImageAt(1, 0), ImageAt(2, 1)}, {})));
}

TEST(MeasureModel, ReadsAModelFolder) {
  const TempDir dir;
  WriteTinyModel(dir.path());
  const ModelQuality model = MeasureModel(dir.path());
  EXPECT_EQ(model.registered(), 3);
  EXPECT_EQ(model.points, 1);
  EXPECT_EQ(model.reprojection_error, .5);
  EXPECT_THAT(MessageOf<InputError>([&] { MeasureModel(dir / "nowhere"); }), testing::HasSubstr("nowhere"));
}

TEST(HasLooseView, FindsFewPointsAndFarNeighbors) {
  ModelQuality model = Quality(3, 300);
  for (auto& [name, image] : model.images) image = {300, 20, 10};
  EXPECT_FALSE(HasLooseView(model));
  model.images.begin()->second.points = 99;
  EXPECT_TRUE(HasLooseView(model));
  model.images.begin()->second = {300, 70, 60};
  EXPECT_TRUE(HasLooseView(model));
}

TEST(MisplacedViews, HaveNoDepthWhereOthersHaveMuch) {
  EXPECT_EQ(MisplacedViews({.6, .02, .5, .3}), std::vector<size_t>{1});
  EXPECT_TRUE(MisplacedViews({.6, .1, .5, .3}).empty());
  EXPECT_TRUE(MisplacedViews({.04, .02, .05, .3}).empty()) << "these photos show no depth anyway";
  EXPECT_TRUE(MisplacedViews({}).empty());
}

TEST(IsSound, RequiresImagesPointsAnglesAndIntrinsics) {
  EXPECT_TRUE(IsSound(Quality(2, 12)));
  EXPECT_FALSE(IsSound(Quality(1, 100)));
  EXPECT_FALSE(IsSound(Quality(3, 11))) << "what guided matching made of 3 images of fox";
  EXPECT_FALSE(IsSound(Quality(3, 100, .5, .1)));
  ModelQuality far = Quality(2, 37);
  for (auto& [name, image] : far.images) image.nearest_degrees = 120;
  EXPECT_FALSE(IsSound(far)) << "what relaxed thresholds made of 4 images of fox";
  ModelQuality odd = Quality(3, 100);
  odd.plausible_intrinsics = false;
  EXPECT_FALSE(IsSound(odd));
  EXPECT_FALSE(IsSound({}));
}

TEST(IsBetter, ComparesSoundnessImagesPointsAndError) {
  EXPECT_TRUE(IsBetter(Quality(2, 100), Quality(9, 10))) << "the second is not sound";
  EXPECT_TRUE(IsBetter(Quality(4, 100), Quality(3, 900)));
  EXPECT_TRUE(IsBetter(Quality(3, 120, .9), Quality(3, 100, .1)));
  EXPECT_FALSE(IsBetter(Quality(3, 100, .1), Quality(3, 120, .9)));
  EXPECT_TRUE(IsBetter(Quality(3, 100, .4), Quality(3, 105, .5)));
  EXPECT_FALSE(IsBetter(Quality(3, 100), Quality(3, 100))) << "equal: what stands is kept";
  EXPECT_TRUE(IsBetter(Quality(2, 12), {}));
}

}  // namespace
}  // namespace oraclegs
