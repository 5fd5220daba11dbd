#include "oraclegs/camera/fisheye_lens.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "oraclegs/camera/distortion_models.h"

namespace oraclegs {
namespace {

constexpr double kMaxFlat = kMaxFlatDegrees * std::numbers::pi / 180;
constexpr int kBorderSteps = 16;             // of a side, where angles to the axis are measured
constexpr int kRings = 360, kSpokes = 1440;  // where a photo is looked at: half a degree, and a quarter
constexpr int kMaxBlack = 16;                // level of a pixel that no light reached, noise included
constexpr double kMinLit = .02;              // of a ring; less is a flare, or letters

bool IsLit(const Image8& photo, double x, double y) {
  const int column = std::min(static_cast<int>(x), photo.width - 1),
            row = std::min(static_cast<int>(y), photo.height - 1);
  const size_t at = static_cast<size_t>(row) * static_cast<size_t>(photo.width) + static_cast<size_t>(column);
  const uint8_t* pixel = photo.data.data() + at * static_cast<size_t>(photo.channels);
  if (photo.channels == 4 && pixel[3] < 128) return false;
  return *std::max_element(pixel, pixel + std::min(photo.channels, 3)) > kMaxBlack;
}

}  // namespace

std::optional<FisheyeLens> WideFisheye(const Intrinsics& intrinsics) {
  const DistortionMap map(intrinsics);
  const double end = map.EndOfFisheye();
  if (end <= kMaxFlat) return std::nullopt;
  FisheyeLens lens{intrinsics, 0};
  const auto include = [&](double x, double y) {
    const auto direction = map.UnprojectDirection(x * intrinsics.width, y * intrinsics.height);
    lens.reach = std::max(lens.reach, direction ? std::acos(std::clamp(direction->z(), -1., 1.)) : end);
  };
  for (int i = 0; i <= kBorderSteps; ++i) {
    const double at = static_cast<double>(i) / kBorderSteps;
    include(at, 0), include(at, 1), include(0, at), include(1, at);
  }
  return lens.reach > kMaxFlat ? std::optional(lens) : std::nullopt;
}

double LightReach(const Image8& photo, const FisheyeLens& lens) {
  const DistortionMap map(lens.intrinsics);
  for (int ring = kRings; ring > 0; --ring) {
    const double angle = lens.reach * (ring - .5) / kRings;
    int inside = 0, lit = 0;
    for (int spoke = 0; spoke < kSpokes; ++spoke) {
      const double turn = 2 * std::numbers::pi * spoke / kSpokes;
      const Eigen::Vector3d direction(std::sin(angle) * std::cos(turn), std::sin(angle) * std::sin(turn),
                                      std::cos(angle));
      double x = 0, y = 0;
      if (!map.ProjectDirection(direction, &x, &y) || x < 0 || y < 0 || x > photo.width || y > photo.height) continue;
      ++inside, lit += IsLit(photo, x, y);
    }
    if (lit > kMinLit * inside) return lens.reach * ring / kRings;
  }
  return 0;
}

}  // namespace oraclegs
