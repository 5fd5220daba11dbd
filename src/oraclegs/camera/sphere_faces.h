#pragma once
// Pinhole views that are cut out of a spherical image: the six faces of a cube, each a little larger than its side.

#include <Eigen/Core>
#include <array>

#include "oraclegs/camera/intrinsics.h"
#include "oraclegs/image/image.h"

namespace oraclegs {

/// A direction that a face looks in. A sphere's frame is that of a camera which looks at the middle of the
/// equirectangular image: x right, y down, z forward.
struct SphereFace {
  const char* name;                  ///< "front"
  Eigen::Matrix3d face_from_sphere;  ///< a rotation
};

inline constexpr int kSphereFaces = 6;
/// Front, right, back, left, up and down. Each is upright; up and down are what the front sees when it tilts.
const std::array<SphereFace, kSphereFaces>& SphereFaces();

/// Degrees that a face sees across and down. Beyond the cube's 90 for what else would lose its surroundings at the
/// seams: features, patches of stereo, windows of losses.
inline constexpr double kFaceDegrees = 100;

/// The pinhole camera of the faces of an equirectangular image of `width` pixels: square, in its middle a pixel is one
/// of the image's equator.
Intrinsics FaceIntrinsics(int width);

enum class SphereFilter {
  kBicubic,  ///< for colors [Keys 1981]
  kNearest,  ///< for masks
};

/// An image of what a pinhole camera sees in an equirectangular image of 360 x 180 degrees, of any size and number of
/// channels.
Image8 CutFace(const Image8& sphere, const Eigen::Matrix3d& face_from_sphere, const Intrinsics& face,
               SphereFilter filter);

/// Where an equirectangular image shows a direction (of any length, not zero) of the sphere's frame, in pixels.
Eigen::Vector2d SpherePixel(const Eigen::Vector3d& direction, int width, int height);

}  // namespace oraclegs
