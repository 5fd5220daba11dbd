#include "oraclegs/camera/sphere_faces.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <numbers>

#include "oraclegs/camera/distortion_models.h"
#include "oraclegs/core/parallel.h"

namespace oraclegs {
namespace {

constexpr double kPi = std::numbers::pi;
constexpr double kMinNew = .01;    // of a face of a fisheye photo, not seen by the front
constexpr int kSearchSteps = 256;  // of a face's side, in the search for what the photo shows

Eigen::Matrix3d Rows(const Eigen::Vector3d& right, const Eigen::Vector3d& down, const Eigen::Vector3d& forward) {
  Eigen::Matrix3d rows;
  rows << right.transpose(), down.transpose(), forward.transpose();
  return rows;
}

/// Weights of the four pixels around a position that lies `t` behind the second.
std::array<float, 4> CubicWeights(float t) {
  const float t2 = t * t, t3 = t2 * t;
  return {.5F * (-t3 + 2 * t2 - t), .5F * (3 * t3 - 5 * t2 + 2), .5F * (-3 * t3 + 4 * t2 + t), .5F * (t3 - t2)};
}

const uint8_t* PixelAt(const Image8& image, int x, int y) {
  const size_t at = static_cast<size_t>(y) * static_cast<size_t>(image.width) + static_cast<size_t>(x);
  return image.data.data() + at * static_cast<size_t>(image.channels);
}

/// The pixels of an equirectangular image, without end: columns go around, rows go on behind a pole on its other side.
class SpherePixels {
 public:
  explicit SpherePixels(const Image8& image) : image_(image) {}

  bool Shows(const Eigen::Vector3d& direction, Eigen::Vector2d* at) const {
    *at = SpherePixel(direction, image_.width, image_.height);
    return true;
  }

  const uint8_t* At(int x, int y) const {
    const bool beyond = y < 0 || y >= image_.height;
    if (beyond) x += image_.width / 2;
    y = std::clamp(y < 0 ? -1 - y : (beyond ? 2 * image_.height - 1 - y : y), 0, image_.height - 1);
    while (x < 0) x += image_.width;  // once at most, and cheaper than a division
    while (x >= image_.width) x -= image_.width;
    return PixelAt(image_, x, y);
  }

 private:
  const Image8& image_;
};

/// Which directions a fisheye photo shows, and where.
class FisheyeView {
 public:
  explicit FisheyeView(const FisheyeLens& lens)
      : map_(lens.intrinsics),
        width_(lens.intrinsics.width),
        height_(lens.intrinsics.height),
        cos_reach_(std::cos(lens.reach)) {}

  bool Shows(const Eigen::Vector3d& direction, Eigen::Vector2d* at) const {
    return direction.z() >= cos_reach_ * direction.norm() && map_.ProjectDirection(direction, &at->x(), &at->y()) &&
           at->x() >= 0 && at->y() >= 0 && at->x() <= width_ && at->y() <= height_;
  }

 private:
  DistortionMap map_;
  double width_, height_, cos_reach_;
};

/// The pixels of a fisheye photo; past the outermost the border is repeated.
class FisheyePixels {
 public:
  FisheyePixels(const Image8& image, const FisheyeLens& lens)
      : image_(image), view_({Resized(lens.intrinsics, image.width, image.height), lens.reach}) {}

  bool Shows(const Eigen::Vector3d& direction, Eigen::Vector2d* at) const { return view_.Shows(direction, at); }

  const uint8_t* At(int x, int y) const {
    return PixelAt(image_, std::clamp(x, 0, image_.width - 1), std::clamp(y, 0, image_.height - 1));
  }

 private:
  const Image8& image_;
  FisheyeView view_;
};

template <class Pixels>
void Bicubic(const Pixels& pixels, const Eigen::Vector2d& at, int channels, uint8_t* out) {
  const double left = std::floor(at.x() - .5), top = std::floor(at.y() - .5);
  const auto across = CubicWeights(static_cast<float>(at.x() - .5 - left));
  const auto down = CubicWeights(static_cast<float>(at.y() - .5 - top));
  std::array<float, 4> sums{};
  for (int i = 0; i < 4; ++i) {
    for (int k = 0; k < 4; ++k) {
      const uint8_t* pixel = pixels.At(static_cast<int>(left) + k - 1, static_cast<int>(top) + i - 1);
      const float weight = down[static_cast<size_t>(i)] * across[static_cast<size_t>(k)];
      for (int c = 0; c < channels; ++c) sums[static_cast<size_t>(c)] += weight * static_cast<float>(pixel[c]);
    }
  }
  for (int c = 0; c < channels; ++c) {
    out[c] = static_cast<uint8_t>(std::clamp(sums[static_cast<size_t>(c)] + .5F, 0.F, 255.F));
  }
}

/// The ray (x, y, 1) of a place in a pinhole camera's image.
Eigen::Vector3d RayThrough(const Intrinsics& pinhole, double x, double y) {
  return {(x - pinhole.cx()) / pinhole.fx(), (y - pinhole.cy()) / pinhole.fy(), 1};
}

template <class Pixels>
void Cut(const Pixels& pixels, const Eigen::Matrix3d& face_from_sphere, const Intrinsics& face, SphereFilter filter,
         Image8* out) {
  const Eigen::Matrix3d sphere_from_face = face_from_sphere.transpose();
  const size_t row = static_cast<size_t>(out->width) * static_cast<size_t>(out->channels);
  ParallelFor(out->height, [&](int64_t y) {
    uint8_t* to = out->data.data() + static_cast<size_t>(y) * row;
    for (int x = 0; x < out->width; ++x, to += out->channels) {
      Eigen::Vector2d at;
      if (!pixels.Shows(sphere_from_face * RayThrough(face, x + .5, static_cast<double>(y) + .5), &at)) continue;
      if (filter == SphereFilter::kBicubic) {
        Bicubic(pixels, at, out->channels, to);
      } else {
        std::copy_n(pixels.At(static_cast<int>(std::floor(at.x())), static_cast<int>(std::floor(at.y()))),
                    out->channels, to);
      }
    }
  });
}

/// A square face of this focal length.
Intrinsics SquareFace(double focal) {
  const int side = std::max(1, static_cast<int>(std::lround(2 * focal * std::tan(kFaceDegrees / 2 * kPi / 180))));
  return {CameraModel::kPinhole, side, side, {focal, focal, side / 2.0, side / 2.0}};
}

}  // namespace

const std::array<SphereFace, kSphereFaces>& SphereFaces() {
  static const Eigen::Vector3d x = Eigen::Vector3d::UnitX(), y = Eigen::Vector3d::UnitY(), z = Eigen::Vector3d::UnitZ();
  static const std::array<SphereFace, kSphereFaces> faces{{{"front", Rows(x, y, z)},
                                                           {"right", Rows(-z, y, x)},
                                                           {"back", Rows(-x, y, -z)},
                                                           {"left", Rows(z, y, -x)},
                                                           {"up", Rows(x, z, -y)},
                                                           {"down", Rows(x, -z, y)}}};
  return faces;
}

Intrinsics FaceIntrinsics(int width) { return SquareFace(width / (2 * kPi)); }

std::optional<Intrinsics> FaceIntrinsics(const FisheyeLens& lens, const SphereFace& face) {
  Intrinsics camera = SquareFace(std::sqrt(lens.intrinsics.fx() * lens.intrinsics.fy()));
  const FisheyeView view(lens);
  const Eigen::Matrix3d sphere_from_face = face.face_from_sphere.transpose();
  const bool is_front = face.face_from_sphere.isIdentity();
  const double edge = std::tan(kFaceDegrees / 2 * kPi / 180);
  const int side = camera.width, step = std::max(1, side / kSearchSteps);
  Eigen::AlignedBox2i shown;
  int64_t looked_at = 0, found = 0;
  for (int y = 0; y < side; y += step) {
    for (int x = 0; x < side; x += step, ++looked_at) {
      const Eigen::Vector3d direction = sphere_from_face * RayThrough(camera, x + .5, y + .5);
      Eigen::Vector2d at;
      if (!view.Shows(direction, &at)) continue;
      shown.extend(Eigen::Vector2i(x, y));
      found += is_front || direction.head<2>().cwiseAbs().maxCoeff() > edge * direction.z();
    }
  }
  if (!is_front && static_cast<double>(found) < kMinNew * static_cast<double>(looked_at)) return std::nullopt;
  if (shown.isEmpty()) return camera;
  const Eigen::Vector2i low = (shown.min().array() - step).max(0);
  const Eigen::Vector2i high = (shown.max().array() + 1 + step).min(side);
  camera.width = high.x() - low.x();
  camera.height = high.y() - low.y();
  camera.params[2] -= low.x();
  camera.params[3] -= low.y();
  return camera;
}

Eigen::Vector2d SpherePixel(const Eigen::Vector3d& direction, int width, int height) {
  const double longitude = std::atan2(direction.x(), direction.z());
  const double latitude = std::atan2(direction.y(), std::hypot(direction.x(), direction.z()));
  return {(longitude / (2 * kPi) + .5) * width, (latitude / kPi + .5) * height};
}

Image8 CutFace(const Image8& photo, const std::optional<FisheyeLens>& lens, const Eigen::Matrix3d& face_from_sphere,
               const Intrinsics& face, SphereFilter filter) {
  Image8 out{face.width, face.height, photo.channels, {}};
  out.data.resize(static_cast<size_t>(out.width) * static_cast<size_t>(out.height) * static_cast<size_t>(out.channels));
  if (lens) {
    Cut(FisheyePixels(photo, *lens), face_from_sphere, face, filter, &out);
  } else {
    Cut(SpherePixels(photo), face_from_sphere, face, filter, &out);
  }
  return out;
}

}  // namespace oraclegs
