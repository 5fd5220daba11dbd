#pragma once
// Pinhole views that are cut out of a photo of what is around it, a spherical or a fisheye one: the six faces of a
// cube, each a little larger than its side.

#include <Eigen/Core>
#include <array>
#include <optional>

#include "oraclegs/camera/fisheye_lens.h"
#include "oraclegs/camera/intrinsics.h"
#include "oraclegs/image/image.h"

namespace oraclegs {

/// A direction that a face looks in. A sphere's frame is that of a camera which looks at the middle of the
/// equirectangular image, and a fisheye photo's that of its own: x right, y down, z forward.
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

/// The pinhole camera of a face of a fisheye photo: of kFaceDegrees, less what the photo does not show; in its middle a
/// pixel is one of the photo's middle. nullopt, but of the front, where the photo shows little that is not there.
std::optional<Intrinsics> FaceIntrinsics(const FisheyeLens& lens, const SphereFace& face);

enum class SphereFilter {
  kBicubic,  ///< for colors [Keys 1981]
  kNearest,  ///< for masks
};

/// Image of what a pinhole camera sees in a photo of any size and number of channels: in one of the lens, whose
/// intrinsics are scaled to it, or without one in an equirectangular image of 360 x 180 degrees. Pixels that the photo
/// does not show are 0.
Image8 CutFace(const Image8& photo, const std::optional<FisheyeLens>& lens, const Eigen::Matrix3d& face_from_sphere,
               const Intrinsics& face, SphereFilter filter);

/// Where an equirectangular image shows a direction (of any length, not zero) of the sphere's frame, in pixels.
Eigen::Vector2d SpherePixel(const Eigen::Vector3d& direction, int width, int height);

}  // namespace oraclegs
