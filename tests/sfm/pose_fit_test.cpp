#include "oraclegs/sfm/pose_fit.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <fstream>

#include "support/event_recorder.h"
#include "support/matched_scene.h"
#include "support/temp_dir.h"

namespace oraclegs {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;

std::vector<Eigen::Isometry3d> PosesOf(const MatchedScene& matched) {
  std::vector<Eigen::Isometry3d> poses;
  for (const SceneView& view : matched.scene.views) poses.push_back(*view.cam_from_world);
  return poses;
}

Eigen::Matrix3d Diagonal(double x, double y, double z) { return Eigen::Vector3d(x, y, z).asDiagonal(); }

TEST(FitPoses, AcceptsTruePoses) {
  const PoseFit fit = MakeMatchedScene(8, 40).Fit();
  EXPECT_EQ(fit.verdict, PoseVerdict::kFit);
  EXPECT_EQ(fit.all.pairs, 18);
  EXPECT_EQ(fit.all.matches, 18 * 40);
  EXPECT_GT(fit.all.share, .99);
  EXPECT_LT(fit.all.ErrorInPhoto(), .5);
  EXPECT_THAT(fit.NamesOff(), IsEmpty());
}

TEST(FitPoses, NamesSmallErrors) {
  MatchedScene matched = MakeMatchedScene(8, 40);
  matched.SetPoses(Perturbed(PosesOf(matched), .3, .04));
  const PoseFit fit = matched.Fit();
  EXPECT_EQ(fit.verdict, PoseVerdict::kOff);
  EXPECT_GT(fit.all.ErrorInPhoto(), 1.5);
  EXPECT_FALSE(fit.IsExplained());
  EXPECT_GE(fit.NamesOff().size(), 4u);
}

TEST(FitPoses, NamesTheOneViewThatIsOff) {
  MatchedScene matched = MakeMatchedScene(8, 40);
  auto poses = PosesOf(matched);
  poses[3].prerotate(Eigen::AngleAxisd(.02, Eigen::Vector3d(1, 2, 0).normalized()));
  matched.SetPoses(poses);
  const PoseFit fit = matched.Fit();
  EXPECT_EQ(fit.verdict, PoseVerdict::kOff);
  EXPECT_FALSE(fit.all.IsOff());
  EXPECT_THAT(fit.NamesOff(), ElementsAre("photo3.jpg"));
}

TEST(FitPoses, NamesMistakes) {
  const Eigen::Matrix3d same = Diagonal(1, 1, 1);
  for (const CameraChange& mistake :
       {CameraChange{Diagonal(1, -1, -1), false}, CameraChange{same, true}, CameraChange{Diagonal(-1, 1, 1), false},
        CameraChange{Diagonal(-1, -1, 1), false}, CameraChange{same, false, 2, true}, CameraChange{same, false, .6}}) {
    MatchedScene matched = MakeMatchedScene(8, 40);
    matched.SetPoses(Changed(PosesOf(matched), mistake));
    if (mistake.focal_factor != 1)
      for (SceneView& view : matched.scene.views) view.intrinsics = Changed(view.intrinsics, mistake);
    const PoseFit fit = matched.Fit();
    ASSERT_TRUE(fit.change.has_value());
    EXPECT_EQ(fit.change->change.axes, mistake.axes);
    EXPECT_EQ(fit.change->change.inverse, mistake.inverse);
    EXPECT_NEAR(fit.change->change.focal_factor * mistake.focal_factor, 1, .02);
    EXPECT_GT(fit.change->share, .95);
    EXPECT_LT(fit.all.share, .5);
    EXPECT_EQ(fit.verdict, PoseVerdict::kHopeless) << "a mistake that is known ends the run, however many miss";
  }
}

TEST(FitPoses, NamesNoMistakeByChance) {
  MatchedScene matched = MakeMatchedScene(4, 15);
  const auto poses = PosesOf(matched);
  matched.verified.resize(4);  // with 60 matches some wrong focal length fits more of them than the true one
  for (int strength = 1; strength <= 6; ++strength) {
    matched.SetPoses(Perturbed(poses, .1 * strength, .01 * strength));
    EXPECT_FALSE(matched.Fit().IsExplained()) << strength;
  }
}

TEST(FitPoses, NamesAnotherOrder) {
  MatchedScene matched = MakeMatchedScene(8, 40);
  auto poses = PosesOf(matched);
  std::reverse(poses.begin(), poses.end());
  matched.SetPoses(poses);
  const PoseFit fit = matched.Fit();
  EXPECT_EQ(fit.verdict, PoseVerdict::kHopeless);
  ASSERT_TRUE(fit.order.has_value());
  EXPECT_EQ(fit.order->words, "reversed");
  EXPECT_EQ(fit.order->pose_of_view[0], 7);
}

TEST(FitPoses, NamesPhotosThatStandUpsideDown) {
  for (const std::vector<int>& turned : {std::vector<int>{2}, {1, 2, 5}, {0, 1, 2, 4, 6, 7}}) {
    MatchedScene matched = MakeMatchedScene(8, 40);
    for (VerifiedPair& pair : matched.verified) {
      for (const int view : turned) {
        const std::string& name = matched.plan[static_cast<size_t>(view)].name;
        for (PointMatch& match : pair.matches) {
          if (pair.first == name) match.a = Eigen::Vector2d(800, 600) - match.a;
          if (pair.second == name) match.b = Eigen::Vector2d(800, 600) - match.b;
        }
      }
    }
    const PoseFit fit = matched.Fit();
    ASSERT_TRUE(fit.turned.has_value()) << turned.size();
    EXPECT_EQ(fit.turned->views, turned);
    EXPECT_GT(fit.turned->share, .95);
  }
}

TEST(FitPoses, IsHopelessWithoutAReason) {
  MatchedScene matched = MakeMatchedScene(8, 40);
  matched.SetPoses(Perturbed(PosesOf(matched), 40, 3));
  const PoseFit fit = matched.Fit();
  EXPECT_EQ(fit.verdict, PoseVerdict::kHopeless);
  EXPECT_FALSE(fit.IsExplained());
}

TEST(FitPoses, SaysNothingOfFewMatches) {
  MatchedScene matched = MakeMatchedScene(8, 40);
  matched.SetPoses(Perturbed(PosesOf(matched), 40, 3));
  const auto all = matched.verified;
  matched.verified.resize(1);
  EXPECT_EQ(matched.Fit().verdict, PoseVerdict::kUnknown) << "one pair may show two things that look alike";
  matched.verified = all;
  for (VerifiedPair& pair : matched.verified) pair.matches.resize(14);
  EXPECT_EQ(matched.Fit().verdict, PoseVerdict::kUnknown) << "colmap itself takes 15";
  matched.verified = all;
  for (VerifiedPair& pair : matched.verified) pair.config = TwoViewConfig::kWatermark;
  EXPECT_EQ(matched.Fit().verdict, PoseVerdict::kUnknown) << "what moves with the camera shows no pose";
  matched.verified.clear();
  EXPECT_EQ(matched.Fit().verdict, PoseVerdict::kUnknown);
}

TEST(FitPoses, ForgivesAPairOfThingsThatLookAlike) {
  MatchedScene matched = MakeMatchedScene(8, 40);
  for (size_t k = 0; k < 3; ++k) {  // all pairs of photo 0
    for (PointMatch& match : matched.verified[k].matches) match.b.y() += 25;
  }
  matched.verified.erase(matched.verified.begin() + 1, matched.verified.begin() + 3);
  EXPECT_EQ(matched.Fit().verdict, PoseVerdict::kFit) << "one pair of photo 0 is left";
}

TEST(FitPosesOf, NeedsADatabase) {
  const TempDir dir;
  EventRecorder events;
  const MatchedScene matched = MakeMatchedScene(2, 40);
  EXPECT_FALSE(FitPosesOf(matched.scene, {0, 1}, {0, 0, 0}, dir.path(), events.AsListener()).has_value());
  EXPECT_THAT(events.warnings, IsEmpty());
  std::ofstream(dir / "database.db") << "no database";
  const std::vector<int> none;
  EXPECT_FALSE(FitPosesOf(matched.scene, none, {0, 0, 0}, dir.path(), events.AsListener()).has_value());
  EXPECT_THAT(events.warnings, ElementsAre(HasSubstr("the given poses are not checked")));
}

}  // namespace
}  // namespace oraclegs
