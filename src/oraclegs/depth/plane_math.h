#pragma once
// Planes and the maps between views as plain numbers, for host and device. plane.h has them with Eigen.

#include <cmath>
#include <cstdint>

#include "oraclegs/core/device_macros.h"

namespace oraclegs {

/// A surface patch seen from one camera: its inverse depth at a pixel's center and its change over the image. A plane
/// in space is exactly linear in inverse depth over the image, so the homography it induces needs no normal.
struct Plane {
  float inv_depth = 0;   ///< 1/z, 1/world unit
  float dx = 0, dy = 0;  ///< change per pixel to the right, downward

  /// Inverse depth `x` pixels to the right and `y` down.
  ORACLEGS_HD inline float At(float x, float y) const { return inv_depth + dx * x + dy * y; }
};

struct Vec3f {
  float x = 0, y = 0, z = 0;
};
/// Dot product, added in Eigen's order.
ORACLEGS_HD inline float Dot(const Vec3f& a, const Vec3f& b) { return a.x * b.x + (a.y * b.y + a.z * b.z); }

/// A PixelMap (plane.h): pixel (u, v) with inverse depth w goes to the homogeneous pixel
/// right u + down v + corner + translation w.
struct PlainPixelMap {
  Vec3f right, down, corner, translation;

  ORACLEGS_HD inline Vec3f operator()(float u, float v, float w) const {
    return {right.x * u + down.x * v + corner.x + translation.x * w,
            right.y * u + down.y * v + corner.y + translation.y * w,
            right.z * u + down.z * v + corner.z + translation.z * w};
  }
};

/// The planes of a view's pixels, height * width, in the memory of the device that reads them.
struct KnownPlanes {
  const Plane* planes = nullptr;
  int width = 0, height = 0;

  ORACLEGS_HD inline Plane At(int x, int y) const { return planes[static_cast<int64_t>(y) * width + x]; }
};

/// Round trip of the pixel (u, v) with inverse depth w: mapped to another view, and back with the depth known there.
struct RoundTrip {
  bool seen = false;         ///< whether it falls into the other image, where depth is known
  float pixels = 0;          ///< distance from the start, pixels
  float relative_depth = 0;  ///< depth there, of the point over that of the known surface, minus 1; > 0 = occluded
};
/// Makes the round trip. `Planes` is KnownPlanes, or finds the plane of a pixel in another way.
template <class Planes>
ORACLEGS_HD inline RoundTrip GoAndReturn(const PlainPixelMap& there, const PlainPixelMap& back, const Planes& other,
                                         const Vec3f& uvw) {
  const Vec3f q = there(uvw.x, uvw.y, uvw.z);
  if (!(q.z > 0)) return {};
  const float u = q.x / q.z, v = q.y / q.z;
  if (!(u >= 0 && v >= 0 && u < static_cast<float>(other.width) && v < static_cast<float>(other.height))) return {};
  const int x = static_cast<int>(u), y = static_cast<int>(v);
  const Plane plane = other.At(x, y);
  if (!(plane.inv_depth > 0)) return {};
  const float known = plane.At(u - static_cast<float>(x) - 0.5f, v - static_cast<float>(y) - 0.5f);
  if (!(known > 0)) return {};
  const Vec3f r = back(u, v, known);
  if (!(r.z > 0)) return {};
  const float du = r.x / r.z - uvw.x, dv = r.y / r.z - uvw.y;
  return {true, std::sqrt(du * du + dv * dv), q.z / uvw.z * known - 1};
}

// Constants of patches and of their comparison, for host and device.

/// Radius of the 9 x 9 window, of which a patch has every second pixel, like one color of a checkerboard.
inline constexpr int kPatchRadius = 4;
inline constexpr int kPatchSamples = 41;
inline constexpr int kMaxChannels = 3;

/// The worst cost: 1 - ZNCC of opposite patches; also that of patches that cannot be compared.
inline constexpr float kWorstCost = 2;

/// Standard deviations of the bilateral weights: distance in pixels, value in 8-bit units (mean over the channels).
inline constexpr double kSigmaPixels = 4, kSigmaValue = 20;

/// Variance per channel that 8-bit rounding and sensor noise give a flat patch; without it such patches correlate by
/// chance.
inline constexpr float kNoiseVariance = 1.5f * 1.5f;

/// Least depth of a patch's samples in the source camera, as a fraction of its center's.
inline constexpr float kNearestShare = 0.1f;

}  // namespace oraclegs
