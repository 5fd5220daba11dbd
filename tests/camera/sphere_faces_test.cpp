#include "oraclegs/camera/sphere_faces.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "oraclegs/camera/distortion_models.h"

namespace oraclegs {
namespace {

constexpr double kPi = std::numbers::pi;

/// Smooth colors of each direction.
Eigen::Vector3d ColorOf(const Eigen::Vector3d& direction) {
  const Eigen::Vector3d d = direction.normalized();
  return {128 + 90 * d.x(), 128 + 90 * d.y() * d.z(), 128 + 60 * std::sin(5 * d.z() + 2 * d.y())};
}

/// The ray through the middle of a pixel, by the definition of the projection.
Eigen::Vector3d RayOf(double x, double y, int width, int height) {
  const double longitude = (x / width - .5) * 2 * kPi, latitude = (.5 - y / height) * kPi;
  return {std::cos(latitude) * std::sin(longitude), -std::sin(latitude), std::cos(latitude) * std::cos(longitude)};
}

Image8 PaintSphere(int width) {
  Image8 image{width, width / 2, 3, {}};
  for (int y = 0; y < image.height; ++y) {
    for (int x = 0; x < width; ++x) {
      const Eigen::Vector3d color = ColorOf(RayOf(x + .5, y + .5, width, image.height));
      for (int c = 0; c < 3; ++c) image.data.push_back(static_cast<uint8_t>(std::lround(color[c])));
    }
  }
  return image;
}

/// A lens of 200 degrees in a square image, and what it shows of them.
FisheyeLens WideLens() {
  const Intrinsics camera{CameraModel::kOpenCvFisheye, 300, 300, {82, 84, 151, 148, .03, -.004, 0, 0}};
  return {camera, 100 * kPi / 180};
}

Image8 PaintFisheye(const Intrinsics& camera) {
  Image8 image{camera.width, camera.height, 3, {}};
  const DistortionMap map(camera);
  for (int y = 0; y < image.height; ++y) {
    for (int x = 0; x < image.width; ++x) {
      const auto direction = map.UnprojectDirection(x + .5, y + .5);
      const Eigen::Vector3d color = direction ? ColorOf(*direction) : Eigen::Vector3d::Zero();
      for (int c = 0; c < 3; ++c) image.data.push_back(static_cast<uint8_t>(std::lround(color[c])));
    }
  }
  return image;
}

TEST(SpherePixel, IsTheInverseOfTheRays) {
  for (const double x : {.5, 30.25, 100., 199.5}) {
    for (const double y : {.5, 20., 99.5}) {
      EXPECT_NEAR((SpherePixel(3 * RayOf(x, y, 200, 100), 200, 100) - Eigen::Vector2d(x, y)).norm(), 0, 1e-9);
    }
  }
  EXPECT_NEAR((SpherePixel({0, 0, 1}, 200, 100) - Eigen::Vector2d(100, 50)).norm(), 0, 1e-12);
  EXPECT_NEAR((SpherePixel({1, 0, 0}, 200, 100) - Eigen::Vector2d(150, 50)).norm(), 0, 1e-12);
  EXPECT_NEAR(SpherePixel({0, 1, 0}, 200, 100).y(), 100, 1e-12);
}

TEST(SphereFaces, LookInSixDirectionsAndCoverAll) {
  for (const SphereFace& face : SphereFaces()) {
    EXPECT_NEAR((face.face_from_sphere * face.face_from_sphere.transpose() - Eigen::Matrix3d::Identity()).norm(), 0,
                1e-15);
    EXPECT_NEAR(face.face_from_sphere.determinant(), 1, 1e-15) << face.name;
  }
  EXPECT_EQ(SphereFaces()[0].face_from_sphere, Eigen::Matrix3d::Identity());
  EXPECT_STREQ(SphereFaces()[5].name, "down");
  EXPECT_EQ(SphereFaces()[5].face_from_sphere.row(2), Eigen::RowVector3d(0, 1, 0)) << "y is down";
  const double half = std::tan(kFaceDegrees / 2 * kPi / 180);
  for (int y = 0; y < 50; ++y) {
    for (int x = 0; x < 100; ++x) {
      const Eigen::Vector3d ray = RayOf(x + .5, y + .5, 100, 50);
      int seen = 0;
      for (const SphereFace& face : SphereFaces()) {
        const Eigen::Vector3d in_face = face.face_from_sphere * ray;
        seen += in_face.z() > 0 && std::abs(in_face.x()) <= half * in_face.z() &&
                std::abs(in_face.y()) <= half * in_face.z();
      }
      EXPECT_GE(seen, 1) << x << " " << y;
      EXPECT_LE(seen, 3) << x << " " << y;
    }
  }
}

TEST(FaceIntrinsics, KeepTheSizeOfPixels) {
  const Intrinsics camera = FaceIntrinsics(5760);
  EXPECT_EQ(camera.width, camera.height);
  EXPECT_NEAR(2 * std::atan(camera.width / 2. / camera.fx()) * 180 / kPi, kFaceDegrees, .1);
  EXPECT_NEAR(std::atan(1 / camera.fx()), 2 * kPi / 5760, 1e-7);
  EXPECT_NO_THROW(FaceIntrinsics(2).Check("two pixels"));
}

TEST(CutFace, ShowsTheColorOfEachRay) {
  const Image8 sphere = PaintSphere(256);
  const Intrinsics camera = FaceIntrinsics(256);
  for (const SphereFace& face : SphereFaces()) {
    const Image8 cut = CutFace(sphere, std::nullopt, face.face_from_sphere, camera, SphereFilter::kBicubic);
    ASSERT_EQ(cut.width, camera.width);
    double worst = 0;
    for (int y = 0; y < cut.height; ++y) {
      for (int x = 0; x < cut.width; ++x) {
        const Eigen::Vector3d ray((x + .5 - camera.cx()) / camera.fx(), (y + .5 - camera.cy()) / camera.fy(), 1);
        const Eigen::Vector3d wanted = ColorOf(face.face_from_sphere.transpose() * ray);
        for (int c = 0; c < 3; ++c) {
          worst = std::max(worst, std::abs(wanted[c] - cut.data[3 * (static_cast<size_t>(y) * cut.width + x) + c]));
        }
      }
    }
    EXPECT_LT(worst, 1.6) << face.name << ", seams and poles included";  // two roundings of a half, and the filter
  }
}

TEST(CutFace, ShowsTheColorOfEachRayThatAFisheyeShows) {
  const FisheyeLens lens = WideLens();
  const Image8 photo = PaintFisheye(lens.intrinsics);
  const Image8 white{150, 150, 1, std::vector<uint8_t>(150 * 150, 255)};  // a mask of half the size
  for (const SphereFace& face : SphereFaces()) {
    const auto camera = FaceIntrinsics(lens, face);
    ASSERT_EQ(camera.has_value(), face.name != std::string("back")) << face.name;
    if (!camera) continue;
    const Image8 cut = CutFace(photo, lens, face.face_from_sphere, *camera, SphereFilter::kBicubic);
    const Image8 mask = CutFace(white, lens, face.face_from_sphere, *camera, SphereFilter::kNearest);
    ASSERT_EQ(mask.data.size() * 3, cut.data.size());
    double worst = 0;
    int shown = 0;
    for (int y = 0; y < cut.height; ++y) {
      for (int x = 0; x < cut.width; ++x) {
        const Eigen::Vector3d ray((x + .5 - camera->cx()) / camera->fx(), (y + .5 - camera->cy()) / camera->fy(), 1);
        const Eigen::Vector3d direction = (face.face_from_sphere.transpose() * ray).normalized();
        const size_t at = static_cast<size_t>(y) * cut.width + x;
        const auto pixel = [&] {
          Eigen::Vector2d found(-1, -1);
          DistortionMap(lens.intrinsics).ProjectDirection(direction, &found.x(), &found.y());
          return found;
        }();
        const bool is_shown =
            std::acos(direction.z()) <= lens.reach && pixel.minCoeff() >= 0 && pixel.maxCoeff() <= 300;
        ASSERT_EQ(mask.data[at] == 255, is_shown) << face.name << " " << x << " " << y;
        const Eigen::Vector3d wanted = is_shown ? ColorOf(direction) : Eigen::Vector3d::Zero();
        const bool at_border = pixel.minCoeff() < 1.5 || pixel.maxCoeff() > 298.5;  // it is repeated
        shown += is_shown;
        for (int c = 0; c < 3 && !(is_shown && at_border); ++c) {
          worst = std::max(worst, std::abs(wanted[c] - cut.data[3 * at + c]));
        }
      }
    }
    EXPECT_LT(worst, 1.6) << face.name;
    EXPECT_GT(shown, .55 * cut.width * cut.height) << face.name << ": it is cropped to what is shown";
  }
}

TEST(FaceIntrinsics, CoverAllThatAFisheyeShows) {
  const FisheyeLens lens = WideLens();
  const DistortionMap map(lens.intrinsics);
  std::array<std::optional<Intrinsics>, kSphereFaces> cameras;
  for (size_t i = 0; i < cameras.size(); ++i) cameras[i] = FaceIntrinsics(lens, SphereFaces()[i]);
  int shown = 0, covered = 0;
  for (double y = .5; y < 300; y += 3) {
    for (double x = .5; x < 300; x += 3) {
      const auto direction = map.UnprojectDirection(x, y);
      if (!direction || std::acos(direction->z()) > lens.reach) continue;
      bool seen = false;
      for (size_t i = 0; i < cameras.size(); ++i) {
        const auto& camera = cameras[i];
        const Eigen::Vector3d ray = SphereFaces()[i].face_from_sphere * *direction;
        if (!camera || ray.z() <= 0) continue;
        const double u = camera->fx() * ray.x() / ray.z() + camera->cx();
        const double v = camera->fy() * ray.y() / ray.z() + camera->cy();
        seen |= u >= 0 && v >= 0 && u <= camera->width && v <= camera->height;
      }
      ++shown, covered += seen;
    }
  }
  EXPECT_GT(shown, 6000);
  EXPECT_EQ(covered, shown);
}

TEST(FaceIntrinsics, AreOfTheFacesThatAFisheyeFills) {
  const auto names = [](const FisheyeLens& lens) {
    std::string text;
    for (const SphereFace& face : SphereFaces()) {
      if (FaceIntrinsics(lens, face)) text += std::string(face.name) + " ";
    }
    return text;
  };
  const auto square = [](double reach) {
    return FisheyeLens{{CameraModel::kOpenCvFisheye, 400, 400, {90, 90, 200, 200, 0, 0, 0, 0}}, reach};
  };
  EXPECT_EQ(names(square(2.7)), "front right back left up down ");
  EXPECT_EQ(names(square(1.6)), "front right left up down ");
  EXPECT_EQ(names(square(.8)), "front ");
  EXPECT_EQ(names(square(0)), "front ") << "that is black";
  FisheyeLens film = square(1.6);
  film.intrinsics.height = 120, film.intrinsics.params[3] = 60;
  EXPECT_EQ(names(film), "front right left ") << "38 degrees up and down";
  const Intrinsics front = FaceIntrinsics(film, SphereFaces()[0]).value();
  const Intrinsics right = FaceIntrinsics(film, SphereFaces()[1]).value();
  EXPECT_EQ(front.width, std::lround(180 * std::tan(50 * kPi / 180)));
  EXPECT_LT(front.height, .95 * front.width);
  EXPECT_LT(right.width, .6 * front.width) << "half is behind the lens";
  EXPECT_GT(right.cx(), .9 * right.width);
  EXPECT_EQ(right.fx(), 90);
  right.Check("right");
}

TEST(CutFace, TakesMasksAsTheyAre) {
  Image8 mask{64, 32, 1, std::vector<uint8_t>(64 * 32, 255)};
  for (int y = 24; y < 32; ++y) std::fill_n(mask.data.begin() + 64 * y, 64, uint8_t{0});  // 45 degrees and more down
  const Intrinsics camera = FaceIntrinsics(256);
  const Image8 down = CutFace(mask, std::nullopt, SphereFaces()[5].face_from_sphere, camera, SphereFilter::kNearest);
  const Image8 up = CutFace(mask, std::nullopt, SphereFaces()[4].face_from_sphere, camera, SphereFilter::kNearest);
  size_t black = 0;
  for (int y = 0; y < down.height; ++y) {
    for (int x = 0; x < down.width; ++x) {
      const uint8_t level = down.data[static_cast<size_t>(y) * down.width + x];
      EXPECT_EQ(level, std::hypot(x + .5 - camera.cx(), y + .5 - camera.cy()) < camera.fx() ? 0 : 255);
      black += level == 0;
    }
  }
  EXPECT_GT(black, 0u);
  EXPECT_EQ(up.data, std::vector<uint8_t>(up.data.size(), 255));
}

}  // namespace
}  // namespace oraclegs
