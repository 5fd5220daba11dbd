#include "oraclegs/scene/colmap_files.h"

#include <cmath>

#include "scene/tiny_scenes.h"
#include "support/errors.h"

namespace oraclegs {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;

TEST(ColmapBinary, ReadsCameras) {
  const ColmapCameras cameras = ParseCamerasBinary(TinyCamerasBin(), "cameras.bin");
  ASSERT_EQ(cameras.size(), 2u);
  EXPECT_EQ(cameras.at(1).model, CameraModel::kOpenCv);
  EXPECT_EQ(cameras.at(1).width, 6);
  EXPECT_EQ(cameras.at(1).height, 4);
  EXPECT_THAT(cameras.at(1).params, ElementsAre(5, 5.5, 3, 2, 0.1, -0.2, 0.01, 0.02));
  EXPECT_EQ(cameras.at(7).model, CameraModel::kSimplePinhole);
}

TEST(ColmapBinary, ReadsImagesAndNormalizesQuaternions) {
  const auto images = ParseImagesBinary(TinyImagesBin(), "images.bin");
  ASSERT_EQ(images.size(), 3u);
  EXPECT_EQ(images[0].id, 3u);
  EXPECT_EQ(images[0].name, "b.png");
  EXPECT_EQ(images[0].camera_id, 1u);
  // A quarter turn about z takes x to y; the translation is added after it.
  EXPECT_TRUE((images[0].cam_from_world * Eigen::Vector3d(1, 0, 0)).isApprox(Eigen::Vector3d(1, 3, 3), 1e-12));
  EXPECT_TRUE(images[1].cam_from_world.linear().isIdentity(1e-15));
}

TEST(ColmapBinary, ReadsPoints) {
  const auto points = ParsePointsBinary(TinyPointsBin(), "points3D.bin");
  ASSERT_EQ(points.size(), 3u);
  EXPECT_EQ(points[0].xyz, Eigen::Vector3d(1, 2, 3));
  EXPECT_THAT(points[0].rgb, ElementsAre(10, 20, 255));
  EXPECT_THAT(points[0].image_ids, ElementsAre(4, 3, 3));
  EXPECT_EQ(points[0].reprojection_error, .5);
  EXPECT_TRUE(std::isnan(points[1].xyz.x()));
}

TEST(ColmapBinary, RefusesEveryPrefix) {
  const std::string cameras = TinyCamerasBin(), images = TinyImagesBin(), points = TinyPointsBin();
  for (size_t n = 0; n < cameras.size(); ++n) {
    EXPECT_THROW(ParseCamerasBinary(cameras.substr(0, n), "cameras.bin"), InputError) << n;
  }
  for (size_t n = 0; n < images.size(); ++n) {
    EXPECT_THROW(ParseImagesBinary(images.substr(0, n), "images.bin"), InputError) << n;
  }
  for (size_t n = 0; n < points.size(); ++n) {
    EXPECT_THROW(ParsePointsBinary(points.substr(0, n), "points3D.bin"), InputError) << n;
  }
}

TEST(ColmapBinary, SurvivesEveryDamagedByte) {
  const std::string sound[] = {TinyCamerasBin(), TinyImagesBin(), TinyPointsBin()};
  for (const std::string& file : sound) {
    for (size_t i = 0; i < file.size(); ++i) {
      for (const char damage : {'\x00', '\x7f', '\xff'}) {
        std::string bytes = file;
        bytes[i] = damage;
        try {
          ParseCamerasBinary(bytes, "f");
        } catch (const InputError&) {
        }
        try {
          ParseImagesBinary(bytes, "f");
        } catch (const InputError&) {
        }
        try {
          ParsePointsBinary(bytes, "f");
        } catch (const InputError&) {
        }
      }
    }
  }
}

TEST(ColmapBinary, RefusesCountsLargerThanTheFile) {
  const std::string huge = Bytes().Add<uint64_t>(~uint64_t{0}).str();
  EXPECT_THAT(MessageOf<InputError>([&] { ParseImagesBinary(huge, "images.bin"); }),
              HasSubstr("images.bin: promises 18446744073709551615 images"));
  EXPECT_THROW(ParseCamerasBinary(huge, "f"), InputError);
  EXPECT_THROW(ParsePointsBinary(huge, "f"), InputError);
}

std::string OneCamera(int32_t model, uint64_t width, std::initializer_list<double> params) {
  return Bytes().Add<uint64_t>(1).Add<uint32_t>(5).Add(model).Add(width).Add<uint64_t>(4).Add(params).str();
}

TEST(ColmapBinary, RefusesBadCameras) {
  const auto message = [](const std::string& bytes) {
    return MessageOf<InputError>([&] { ParseCamerasBinary(bytes, "cameras.bin"); });
  };
  EXPECT_THAT(message(OneCamera(99, 6, {5, 5, 3, 2})), HasSubstr("cameras.bin: camera 5 has the unknown model id 99"));
  EXPECT_THAT(message(OneCamera(1, 6, {0, 5, 3, 2})), HasSubstr("cameras.bin: camera 5"));
  EXPECT_THAT(message(OneCamera(1, 6, {std::nan(""), 5, 3, 2})), HasSubstr("cameras.bin: camera 5"));
  EXPECT_THAT(message(OneCamera(1, uint64_t{1} << 40, {5, 5, 3, 2})), HasSubstr("damaged"));
  EXPECT_THAT(message(OneCamera(1, 0, {5, 5, 3, 2})), HasSubstr("camera 5"));
}

std::string OneImage(std::initializer_list<double> pose, const std::string& name = "x.png") {
  return Bytes().Add<uint64_t>(1).Add<uint32_t>(1).Add(pose).Add<uint32_t>(1).AddName(name).Add<uint64_t>(0).str();
}

TEST(ColmapBinary, RefusesBadPoses) {
  const auto message = [](const std::string& bytes) {
    return MessageOf<InputError>([&] { ParseImagesBinary(bytes, "images.bin"); });
  };
  const double nan = std::nan(""), inf = std::numeric_limits<double>::infinity();
  EXPECT_THAT(message(OneImage({0, 0, 0, 0, 1, 2, 3})),
              HasSubstr("images.bin: the rotation of image 'x.png' is not one"));
  EXPECT_THAT(message(OneImage({nan, 0, 0, 0, 1, 2, 3})),
              HasSubstr("images.bin: the pose of image 'x.png' is not finite"));
  EXPECT_THAT(message(OneImage({1, 0, 0, 0, 1, inf, 3})), HasSubstr("not finite"));
  EXPECT_THAT(message(OneImage({1e-320, 0, 0, 0, 1, 2, 3})), HasSubstr("is not one"));
  EXPECT_THAT(message(OneImage({1, 0, 0, 0, 1, 2, 3}, "a\nb.png")), HasSubstr("control characters"));
}

}  // namespace
}  // namespace oraclegs
