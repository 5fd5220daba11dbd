#include "oraclegs/camera/sphere_faces.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "oraclegs/core/parallel.h"

namespace oraclegs {
namespace {

constexpr double kPi = std::numbers::pi;

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

/// The pixels of an equirectangular image, without end: columns go around, rows go on behind a pole on its other side.
class SpherePixels {
 public:
  explicit SpherePixels(const Image8& image) : image_(image) {}

  const uint8_t* At(int x, int y) const {
    const bool beyond = y < 0 || y >= image_.height;
    if (beyond) x += image_.width / 2;
    y = std::clamp(y < 0 ? -1 - y : (beyond ? 2 * image_.height - 1 - y : y), 0, image_.height - 1);
    while (x < 0) x += image_.width;  // once at most, and cheaper than a division
    while (x >= image_.width) x -= image_.width;
    const size_t at = static_cast<size_t>(y) * static_cast<size_t>(image_.width) + static_cast<size_t>(x);
    return image_.data.data() + at * static_cast<size_t>(image_.channels);
  }

  void Nearest(const Eigen::Vector2d& at, uint8_t* out) const {
    std::copy_n(At(static_cast<int>(std::floor(at.x())), static_cast<int>(std::floor(at.y()))), image_.channels, out);
  }

  void Bicubic(const Eigen::Vector2d& at, uint8_t* out) const {
    const double left = std::floor(at.x() - .5), top = std::floor(at.y() - .5);
    const auto across = CubicWeights(static_cast<float>(at.x() - .5 - left));
    const auto down = CubicWeights(static_cast<float>(at.y() - .5 - top));
    std::array<float, 4> sums{};
    for (int i = 0; i < 4; ++i) {
      for (int k = 0; k < 4; ++k) {
        const uint8_t* pixel = At(static_cast<int>(left) + k - 1, static_cast<int>(top) + i - 1);
        const float weight = down[static_cast<size_t>(i)] * across[static_cast<size_t>(k)];
        for (int c = 0; c < image_.channels; ++c) sums[static_cast<size_t>(c)] += weight * static_cast<float>(pixel[c]);
      }
    }
    for (int c = 0; c < image_.channels; ++c) {
      out[c] = static_cast<uint8_t>(std::clamp(sums[static_cast<size_t>(c)] + .5F, 0.F, 255.F));
    }
  }

 private:
  const Image8& image_;
};

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

Intrinsics FaceIntrinsics(int width) {
  const double focal = width / (2 * kPi);
  const int side = std::max(1, static_cast<int>(std::lround(2 * focal * std::tan(kFaceDegrees / 2 * kPi / 180))));
  return {CameraModel::kPinhole, side, side, {focal, focal, side / 2.0, side / 2.0}};
}

Eigen::Vector2d SpherePixel(const Eigen::Vector3d& direction, int width, int height) {
  const double longitude = std::atan2(direction.x(), direction.z());
  const double latitude = std::atan2(direction.y(), std::hypot(direction.x(), direction.z()));
  return {(longitude / (2 * kPi) + .5) * width, (latitude / kPi + .5) * height};
}

Image8 CutFace(const Image8& sphere, const Eigen::Matrix3d& face_from_sphere, const Intrinsics& face,
               SphereFilter filter) {
  Image8 out{face.width, face.height, sphere.channels, {}};
  const size_t row = static_cast<size_t>(out.width) * static_cast<size_t>(out.channels);
  out.data.resize(row * static_cast<size_t>(out.height));
  const SpherePixels pixels(sphere);
  const Eigen::Matrix3d sphere_from_face = face_from_sphere.transpose();
  ParallelFor(out.height, [&](int64_t y) {
    uint8_t* to = out.data.data() + static_cast<size_t>(y) * row;
    for (int x = 0; x < out.width; ++x, to += out.channels) {
      const Eigen::Vector3d ray((x + .5 - face.cx()) / face.fx(), (static_cast<double>(y) + .5 - face.cy()) / face.fy(),
                                1);
      const Eigen::Vector2d at = SpherePixel(sphere_from_face * ray, sphere.width, sphere.height);
      filter == SphereFilter::kNearest ? pixels.Nearest(at, to) : pixels.Bicubic(at, to);
    }
  });
  return out;
}

}  // namespace oraclegs
