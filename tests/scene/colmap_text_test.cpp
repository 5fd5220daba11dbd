#include "oraclegs/scene/colmap_files.h"

#include "scene/tiny_scenes.h"
#include "support/errors.h"

namespace oraclegs {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;

TEST(ColmapText, ReadsCamerasWithCommentsAndBlankLines) {
  const auto cameras = ParseCamerasText(
      "# Camera list\r\n\r\n1 OPENCV 6 4 5 5.5 3 2 0.1 -2e-1 0.01 0.02\r\n  7\tSIMPLE_PINHOLE 6 4 5 3 2",
      "cameras.txt");
  ASSERT_EQ(cameras.size(), 2u);
  EXPECT_EQ(cameras.at(1).model, CameraModel::kOpenCv);
  EXPECT_THAT(cameras.at(1).params, ElementsAre(5, 5.5, 3, 2, 0.1, -0.2, 0.01, 0.02));
  EXPECT_THAT(cameras.at(7).params, ElementsAre(5, 3, 2));
}

TEST(ColmapText, ReadsImagesWithEmptyKeypointLines) {
  const auto images = ParseImagesText(
      "# header\n"
      "1 1 0 0 0 0 0 0 1 first.jpg\n"
      "\n"
      "\n"
      "2 1 0 0 0 0 0 5 1 folder/my photo.jpg\n"
      "1.5 2.5 -1 3.5 4.5 17\n"
      "3 0 1 0 0 1 2 3 1 last.jpg",  // no second line at all at the end of the file
      "images.txt");
  ASSERT_EQ(images.size(), 3u);
  EXPECT_EQ(images[0].name, "first.jpg");
  EXPECT_EQ(images[1].name, "folder/my photo.jpg");
  EXPECT_EQ(images[1].cam_from_world.translation(), Eigen::Vector3d(0, 0, 5));
  EXPECT_EQ(images[2].id, 3u);
  EXPECT_TRUE(images[2].cam_from_world.linear().isApprox(Eigen::Vector3d(1, -1, -1).asDiagonal().toDenseMatrix()));
}

TEST(ColmapText, ReadsPoints) {
  const auto points =
      ParsePointsText("# POINT3D_ID\n5 1 2 3 10 20 255 0.7 4 0 3 1\n6 4 5 6 0 0 0 -1\n", "points3D.txt");
  ASSERT_EQ(points.size(), 2u);
  EXPECT_EQ(points[0].xyz, Eigen::Vector3d(1, 2, 3));
  EXPECT_THAT(points[0].rgb, ElementsAre(10, 20, 255));
  EXPECT_THAT(points[0].image_ids, ElementsAre(4, 3));
  EXPECT_EQ(points[0].reprojection_error, .7);
  EXPECT_TRUE(points[1].image_ids.empty());
}

TEST(ColmapText, NamesLineAndFault) {
  const auto cameras = [](const char* text) {
    return MessageOf<InputError>([&] { ParseCamerasText(text, "cameras.txt"); });
  };
  EXPECT_THAT(cameras("#\n1 OPENCV 6 4 5 five 3 2"), HasSubstr("cameras.txt line 2: 'five' is not a number"));
  EXPECT_THAT(cameras("1 FANCY 6 4 5 3 2"), HasSubstr("cameras.txt line 1: unknown camera model 'FANCY'"));
  EXPECT_THAT(cameras("1 PINHOLE 6 4 5 3 2"), HasSubstr("cameras.txt: camera 1"));
  EXPECT_THAT(cameras("1 PINHOLE 6 4 0 5 3 2"), HasSubstr("cameras.txt: camera 1"));
  EXPECT_THAT(cameras("1 PINHOLE 6"), HasSubstr("line 1: ends before the image size"));
  EXPECT_THAT(cameras("1 PINHOLE 6 4 5 5 3 2\n1 PINHOLE 6 4 5 5 3 2"), HasSubstr("camera 1 is there twice"));

  const auto images = [](const char* text) {
    return MessageOf<InputError>([&] { ParseImagesText(text, "images.txt"); });
  };
  EXPECT_THAT(images("1 0 0 0 0 0 0 0 1 a.jpg\n\n"), HasSubstr("images.txt: the rotation of image 'a.jpg' is not one"));
  EXPECT_THAT(images("1 nan 0 0 0 0 0 0 1 a.jpg\n\n"),
              HasSubstr("images.txt: the pose of image 'a.jpg' is not finite"));
  EXPECT_THAT(images("1 1 0 0 0 0 0 0 1\n\n"), HasSubstr("line 1: the image's name is missing"));
  EXPECT_THAT(images("1 1 0 0 0 0 0 0 1 a.jpg\n2 1 0 0 0 b.jpg\n"), HasSubstr("line 2: expected the keypoints"));
  EXPECT_THAT(images("1 1 0 0 0 0 0 0 1 a.jpg\n1.5 2.5 -1 3.5\n"), HasSubstr("line 2: expected the keypoints"));

  const auto points = [](const char* text) {
    return MessageOf<InputError>([&] { ParsePointsText(text, "points3D.txt"); });
  };
  EXPECT_THAT(points("1 1 2 3 10 20 256 0.5"), HasSubstr("points3D.txt line 1: '256' is not a number"));
  EXPECT_THAT(points("1 1 2 3 10 20 25 0.5 4"), HasSubstr("ends before a keypoint index"));
}

TEST(ColmapText, ReadsImagesOfOneLine) {
  // The words of each line are a multiple of three, as those of keypoints.
  const auto images = ParseImagesText(
      "1 1 0 0 0 0 0 1 1 IMG 000 (1).jpg\n2 1 0 0 0 0 0 2 1 IMG 001 (1).jpg\n# three\n3 1 0 0 0 0 0 3 1 c.jpg\n\n"
      "4 1 0 0 0 0 0 4 1 d.jpg\n",
      "images.txt");
  ASSERT_EQ(images.size(), 4u);
  EXPECT_EQ(images[0].name, "IMG 000 (1).jpg");
  EXPECT_EQ(images[1].name, "IMG 001 (1).jpg");
  EXPECT_EQ(images[3].cam_from_world.translation().z(), 4);
}

TEST(ColmapText, ReadsNumbersOfOtherWriters) {
  const auto cameras = ParseCamerasText(
      "\xEF\xBB\xBF"
      "1.0 PINHOLE 6.0 +4 +5.0 5 3 2\r\n",
      "cameras.txt");
  EXPECT_EQ(cameras.at(1).width, 6);
  EXPECT_EQ(cameras.at(1).fx(), 5);
  const auto points = ParsePointsText(
      "\xEF\xBB\xBF"
      "1 1 +2 3 10.0 2e1 255.0 0.5 4.0 0\r\n",
      "points3D.txt");
  EXPECT_THAT(points.at(0).rgb, ElementsAre(10, 20, 255));
  EXPECT_THAT(points[0].image_ids, ElementsAre(4));
  EXPECT_EQ(ParseImagesText("\xEF\xBB\xBF# ids\r\n1 1 0 0 0 0 0 0 1 a.jpg\r\n\r\n", "images.txt").size(), 1u);
  EXPECT_THAT(MessageOf<InputError>([] { ParseCamerasText("1 PINHOLE 6.5 4 5 5 3 2", "cameras.txt"); }),
              HasSubstr("'6.5' is not a number"));
  EXPECT_THAT(MessageOf<InputError>([] {
                ParseCamerasText(std::string("\xFF\xFE"
                                             "1\0",
                                             4),
                                 "cameras.txt");
              }),
              HasSubstr("UTF-16"));
}

TEST(ColmapText, NamesTheWayOutOfNewerModels) {
  EXPECT_THAT(MessageOf<InputError>([] { ParseCamerasText("1 SIMPLE_DIVISION 6 4 5 3 2 -.01", "cameras.txt"); }),
              HasSubstr("colmap image_undistorter"));
}

TEST(ColmapText, SurvivesEveryPrefix) {
  const std::string cameras = "1 OPENCV 6 4 5 5.5 3 2 0.1 -2e-1 0.01 0.02\n";
  const std::string images = "1 1 0 0 0 0 0 0 1 a.jpg\n1 2 -1\n";
  const std::string points = "5 1 2 3 10 20 255 0.7 4 0 3 1\n";
  const auto survive = [](const std::string& text, auto parse) {
    for (size_t n = 0; n <= text.size(); ++n) {
      try {
        parse(text.substr(0, n), "f");
      } catch (const InputError& error) {
        EXPECT_THAT(error.what(), HasSubstr("f"));
      }
    }
  };
  survive(cameras, ParseCamerasText);
  survive(images, ParseImagesText);
  survive(points, ParsePointsText);
  survive(TinyImagesBin(), ParseImagesText);  // a .bin under the wrong name
}

}  // namespace
}  // namespace oraclegs
