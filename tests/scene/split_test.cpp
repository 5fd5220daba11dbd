#include "oraclegs/scene/split.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "oraclegs/core/error.h"
#include "scene/tiny_scenes.h"
#include "support/errors.h"

namespace oraclegs {
namespace {

using ::testing::AllOf;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;

Scene SceneOf(const std::vector<std::string>& names) {
  Scene scene;
  scene.root = "SCENE";
  scene.format = SceneFormat::kTransforms;
  for (const std::string& name : names) {
    scene.views.emplace_back();
    scene.views.back().name = name;
  }
  return scene;
}

Scene NumberedScene(int n) {
  std::vector<std::string> names;
  for (int i = 0; i < n; ++i) names.push_back(fmt::format("images/{:04}.jpg", i));
  return SceneOf(names);
}

SplitOptions Options(int views, int test_every = 8) {
  SplitOptions options;
  options.views = views;
  options.test_every = test_every;
  return options;
}

std::string SplitError(const Scene& scene, const SplitOptions& options) {
  return MessageOf<InputError>([&] { SplitViews(scene, options); });
}

TEST(SplitViews, TrainsAllUnlessAskedToEvaluate) {
  const Split split = SplitViews(NumberedScene(3), {});
  EXPECT_THAT(split.test, ElementsAre());
  EXPECT_THAT(split.train, ElementsAre(0, 1, 2));
}

TEST(SplitViews, TestsEveryEighth) {
  const Split split = SplitViews(NumberedScene(10), {.eval = true});
  EXPECT_THAT(split.test, ElementsAre(0, 8));
  EXPECT_THAT(split.train, ElementsAre(1, 2, 3, 4, 5, 6, 7, 9));
}

TEST(SplitViews, GivesThePapersSplitOfFiftyViews) {  // the numbers of the scene "fox"
  const Split split = SplitViews(NumberedScene(50), Options(12));
  EXPECT_THAT(split.test, ElementsAre(0, 8, 16, 24, 32, 40, 48));
  // int(i * 42 / 11) for i = 0..11 is 0 3 7 11 15 19 22 26 30 34 38 42 among the 43 that are left.
  EXPECT_THAT(split.train, ElementsAre(1, 4, 9, 13, 18, 22, 26, 30, 35, 39, 44, 49));
}

TEST(SplitViews, PicksDistinctViewsWithTheEnds) {
  for (int n = 2; n <= 40; ++n) {
    const Scene scene = NumberedScene(n);
    for (int count = 2; count <= n; ++count) {
      const Split split = SplitViews(scene, Options(count, 0));
      ASSERT_EQ(split.train.size(), static_cast<size_t>(count));
      EXPECT_TRUE(std::is_sorted(split.train.begin(), split.train.end(), std::less_equal<>())) << n << " " << count;
      EXPECT_EQ(split.train.front(), 0);
      EXPECT_EQ(split.train.back(), n - 1);
    }
  }
}

TEST(SplitViews, RoundsPositionsWhereAsked) {  // 17 views are left of 20, as of LLFF's "fern"
  SplitOptions options = Options(6);
  const auto positions = [&] {
    const Split split = SplitViews(NumberedScene(20), options);
    const std::vector<int> left = {1, 2, 3, 4, 5, 6, 7, 9, 10, 11, 12, 13, 14, 15, 17, 18, 19};
    std::vector<int> found;
    for (const int v : split.train)
      found.push_back(static_cast<int>(std::find(left.begin(), left.end(), v) - left.begin()));
    return found;
  };
  EXPECT_THAT(positions(), ElementsAre(0, 3, 6, 9, 12, 16));
  options.view_steps = ViewSteps::kRound;
  EXPECT_THAT(positions(), ElementsAre(0, 3, 6, 10, 13, 16));
}

TEST(SplitViews, HoldsNothingOutAtZero) {
  const Split split = SplitViews(NumberedScene(4), Options(0, 0));
  EXPECT_THAT(split.test, IsEmpty());
  EXPECT_THAT(split.train, ElementsAre(0, 1, 2, 3));
}

TEST(SplitViews, TakesNamedTestViews) {
  const Scene scene = SceneOf({"x/7103.jpg", "x/7104.jpg", "x/7105.jpg", "y/7104.jpg", "y/7106.jpg"});
  EXPECT_THAT(SplitViews(scene, {.test_views = "7103, x/7104.jpg ,7106.jpg"}).test, ElementsAre(0, 1, 4));
  EXPECT_THAT(SplitViews(scene, {.test_views = "y/7104,7103,7103"}).test, ElementsAre(0, 3));
  EXPECT_THAT(SplitViews(scene, {.test_views = "7103"}).train, ElementsAre(1, 2, 3, 4));
  EXPECT_THAT(SplitError(scene, {.test_views = "7104"}), HasSubstr("could be any of x/7104.jpg, y/7104.jpg"));
  EXPECT_THAT(SplitError(scene, {.test_views = "7103,9999"}),
              AllOf(HasSubstr("no view is called '9999'"), HasSubstr("x/7103.jpg, x/7104.jpg")));
}

TEST(SplitViews, TakesNamedTrainingViews) {
  const Scene scene = NumberedScene(10);
  Split split = SplitViews(scene, {.eval = true, .train_views = "0002,:5,images/0008.jpg"});
  EXPECT_THAT(split.train, ElementsAre(2, 5, 8));
  EXPECT_THAT(split.test, ElementsAre(0)) << "every 8th, but those that train";
  split = SplitViews(scene, {.train_views = ":1,:3,:5,:7", .test_views = ":0,:9"});
  EXPECT_THAT(split.train, ElementsAre(1, 3, 5, 7));
  EXPECT_THAT(split.test, ElementsAre(0, 9));
  EXPECT_THAT(SplitViews(scene, {.views = 2, .train_views = ":1,:3,:5,:7"}).train, ElementsAre(1, 7));
}

TEST(SplitViews, RefusesListsThatOverlap) {
  EXPECT_THAT(SplitError(NumberedScene(10), {.train_views = ":1,:2,:3", .test_views = ":3,:4"}),
              AllOf(HasSubstr("--train-views and --test-views"), HasSubstr("images/0003.jpg")));
}

TEST(SplitViews, RefusesAPositionBeyondTheViews) {
  EXPECT_THAT(SplitError(NumberedScene(10), {.train_views = ":1,:10"}),
              AllOf(HasSubstr("--train-views asks for view :10"), HasSubstr(":0 to :9")));
}

TEST(SplitViews, NamesATestViewWithoutImage) {
  Scene scene = NumberedScene(5);
  scene.missing_images = {"images/gone.jpg"};
  EXPECT_THAT(SplitError(scene, {.test_views = "gone"}), HasSubstr("'gone' in --test-views has no image file"));
}

TEST(SplitViews, TakesBlendersFiles) {
  Scene scene = SceneOf({"test/r_0", "test/r_1", "train/r_0", "train/r_1", "train/r_2", "train/r_3", "val/r_0"});
  scene.format = SceneFormat::kBlender;
  for (SceneView& view : scene.views) {
    view.role = view.name[0] == 'v'   ? DeclaredRole::kVal
                : view.name[1] == 'e' ? DeclaredRole::kTest
                                      : DeclaredRole::kTrain;
  }
  const Split split = SplitViews(scene, Options(0, 2));
  EXPECT_THAT(split.test, ElementsAre(0, 1));
  EXPECT_THAT(split.train, ElementsAre(2, 3, 4, 5));
  EXPECT_THAT(SplitViews(scene, Options(3)).train, ElementsAre(2, 3, 5));
  const Split named = SplitViews(scene, {.test_views = "train/r_1,val/r_0"});
  EXPECT_THAT(named.test, ElementsAre(3, 6));
  EXPECT_THAT(named.train, ElementsAre(2, 4, 5));
}

TEST(SplitViews, RefusesTooFewTrainingViews) {
  EXPECT_THAT(SplitError(SceneOf({}), {}), HasSubstr("0 of 0 photos for training"));
  EXPECT_THAT(SplitError(NumberedScene(1), Options(0, 0)), HasSubstr("one photo is not enough; give 3 or more"));
  EXPECT_THAT(SplitError(NumberedScene(2), {.eval = true}),
              HasSubstr("1 of 2 photos for training beside 1 test view;"));
  EXPECT_THAT(SplitError(NumberedScene(9), Options(1)), HasSubstr("1 of 9 photos for training"));
  EXPECT_THAT(SplitError(NumberedScene(9), Options(0, 1)), HasSubstr("0 of 9 photos for training"));
}

TEST(SplitViews, RefusesMoreViewsThanExist) {
  EXPECT_THAT(SplitError(NumberedScene(10), Options(9)),
              AllOf(HasSubstr("asks for 9 training views"), HasSubstr("only 8 are left")));
  EXPECT_EQ(SplitViews(NumberedScene(10), Options(8)).train.size(), 8u);
}

TEST(SplitToJson, ListsNames) {
  const Scene scene = NumberedScene(4);
  const nlohmann::json json = SplitToJson(scene, SplitViews(scene, {.eval = true}));
  EXPECT_EQ(json.dump(),
            R"({"test":["images/0000.jpg"],"train":["images/0001.jpg","images/0002.jpg","images/0003.jpg"]})");
}

}  // namespace
}  // namespace oraclegs
