#include "oraclegs/sfm/pose_fit.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "support/matched_scene.h"

namespace oraclegs {
namespace {

using testing::AllOf;
using testing::HasSubstr;
using testing::Not;
using testing::StartsWith;

Eigen::Matrix3d Flip(double x, double y, double z) { return Eigen::Vector3d(x, y, z).asDiagonal(); }

/// Words for poses that are right after this change.
std::string WordsAfter(const CameraChange& fits, SceneFormat format = SceneFormat::kTransforms) {
  Scene scene = MakeMatchedScene(4, 20).scene;
  scene.format = format;
  PoseFit fit;
  fit.verdict = PoseVerdict::kHopeless;
  fit.all = {"", 400, 3, 90, .02, 1, 800};
  fit.change = ChangeFit{fits, .961};
  return DescribeMisfit(scene, fit);
}

TEST(DescribeMisfit, IsSilentWherePosesFit) {
  const MatchedScene matched = MakeMatchedScene(6, 40);
  EXPECT_EQ(DescribeMisfit(matched.scene, matched.Fit()), "");
  EXPECT_EQ(DescribeMisfit(matched.scene, {}), "");
}

TEST(DescribeMisfit, NamesAxes) {
  EXPECT_EQ(WordsAfter({Flip(1, -1, -1)}),
            "the given poses do not fit the photos: 2 % of 400 matches between them fit; with the axes of OpenCV 96 % "
            "of the matches fit: negate the second and third columns of each transform_matrix, whose axes are those of "
            "OpenGL (y up, z back)");
  EXPECT_THAT(WordsAfter({Flip(1, -1, -1)}, SceneFormat::kColmap), HasSubstr("with the axes of OpenGL 96 %"));
  EXPECT_THAT(WordsAfter({Flip(-1, 1, 1)}), HasSubstr("with the photos mirrored left to right 96 %"));
  EXPECT_THAT(WordsAfter({Flip(1, -1, 1)}), HasSubstr("mirrored top to bottom"));
  EXPECT_THAT(WordsAfter({Flip(1, 1, -1)}), AllOf(HasSubstr("(x, y, -z right, down and forward)"), HasSubstr("Unity")));
  EXPECT_THAT(WordsAfter({Flip(-1, 1, -1)}), HasSubstr("with other axes (-x, y, -z right, down and forward)"));
}

TEST(DescribeMisfit, NamesTurns) {
  Eigen::Matrix3d turned;
  turned << 0, 1, 0, -1, 0, 0, 0, 0, 1;  // what is up for the poses is left in the photo
  EXPECT_THAT(WordsAfter({turned}),
              AllOf(HasSubstr("with the photos turned by 90 degrees"), HasSubstr("turn each by 90 degrees clockwise")));
  EXPECT_THAT(WordsAfter({turned.transpose()}), HasSubstr("90 degrees counterclockwise"));
  EXPECT_THAT(WordsAfter({Flip(-1, -1, 1)}), AllOf(HasSubstr("turned by 180 degrees"), HasSubstr("EXIF")));
}

TEST(DescribeMisfit, NamesInversion) {
  EXPECT_THAT(WordsAfter({Flip(1, -1, -1), true}), HasSubstr("with the matrices inverted 96 %"));
  EXPECT_THAT(WordsAfter({Flip(1, 1, 1), true}), HasSubstr("with the matrices inverted and the axes of OpenCV 96 %"));
  EXPECT_THAT(WordsAfter({Flip(1, 1, 1), true}, SceneFormat::kColmap), HasSubstr("with the poses inverted 96 %"));
}

TEST(DescribeMisfit, NamesFocalLength) {
  EXPECT_THAT(WordsAfter({Flip(1, 1, 1), false, 1.5}),
              AllOf(HasSubstr("with a focal length 1.50 times as long 96 %"), HasSubstr("check fl_x")));
  EXPECT_THAT(WordsAfter({Flip(1, 1, 1), false, .5, true}),
              AllOf(HasSubstr("with the cameras of photos 0.50 times as large"), HasSubstr("another resolution")));
}

TEST(DescribeMisfit, NamesAnotherOrder) {
  const Scene scene = MakeMatchedScene(4, 20).scene;
  PoseFit fit;
  fit.verdict = PoseVerdict::kHopeless;
  fit.all = {"", 400, 3, 90, .02, 1, 800};
  fit.views = {{"photo0.jpg"}, {"photo1.jpg"}, {"photo2.jpg"}, {"photo3.jpg"}};
  fit.order = PhotoOrder{{3, 1, 2, 0}, "reversed", .9};
  EXPECT_THAT(DescribeMisfit(scene, fit),
              HasSubstr("with the photos in another order (reversed) 90 % of the matches fit: give each photo its own "
                        "pose: photo3.jpg has that of photo0.jpg, photo0.jpg has that of photo3.jpg"));
}

TEST(DescribeMisfit, NamesTurnedPhotos) {
  const Scene scene = MakeMatchedScene(4, 20).scene;
  PoseFit fit;
  fit.verdict = PoseVerdict::kOff;
  fit.all = {"", 400, 3, 90, .5, 1, 800};
  fit.views = {{"photo0.jpg"}, {"photo1.jpg"}, {"photo2.jpg"}, {"photo3.jpg"}};
  fit.turned = TurnedViews{{1, 3}, .9};
  EXPECT_THAT(DescribeMisfit(scene, fit),
              HasSubstr("with photo1.jpg, photo3.jpg turned by 180 degrees 90 % of the matches fit: these photos stand "
                        "upside down"));
}

TEST(DescribeMisfit, SaysHowFarViewsAreOff) {
  MatchedScene matched = MakeMatchedScene(8, 40);
  std::vector<Eigen::Isometry3d> poses;
  for (const SceneView& view : matched.scene.views) poses.push_back(*view.cam_from_world);
  matched.SetPoses(Perturbed(poses, .3, .04));
  EXPECT_THAT(DescribeMisfit(matched.scene, matched.Fit()),
              AllOf(StartsWith("the given poses are a little wrong: half of the points"), HasSubstr(" pixels ("),
                    HasSubstr("most in photo"), HasSubstr("/scene/images")));
  poses[5].prerotate(Eigen::AngleAxisd(.02, Eigen::Vector3d::UnitX()));
  matched.SetPoses(poses);
  EXPECT_THAT(DescribeMisfit(matched.scene, matched.Fit()),
              AllOf(StartsWith("the given poses of photo5.jpg ("), Not(HasSubstr("photo6"))));
}

TEST(DescribeMisfit, HasAWayOutWithoutAReason) {
  MatchedScene matched = MakeMatchedScene(8, 40);
  std::vector<Eigen::Isometry3d> poses;
  for (const SceneView& view : matched.scene.views) poses.push_back(*view.cam_from_world);
  matched.SetPoses(Perturbed(poses, 40, 3));
  EXPECT_THAT(DescribeMisfit(matched.scene, matched.Fit()),
              AllOf(HasSubstr("no usual mistake explains it"), HasSubstr("have them found")));
}

TEST(ToJson, HasEveryViewInPixelsOfThePhotos) {
  const nlohmann::json json = ToJson(MakeMatchedScene(8, 40).Fit());
  EXPECT_EQ(json.at("verdict"), "fit");
  EXPECT_EQ(json.at("matches"), 18 * 40);
  EXPECT_EQ(json.at("views").size(), 8u);
  EXPECT_EQ(json.at("views")[3].at("name"), "photo3.jpg");
  EXPECT_LT(json.at("views")[3].at("error_pixels"), .5);
}

}  // namespace
}  // namespace oraclegs
