#pragma once
// Fisheye photos that see more than one pinhole view can show.

#include <optional>

#include "oraclegs/camera/intrinsics.h"
#include "oraclegs/image/image.h"

namespace oraclegs {

struct FisheyeLens {
  Intrinsics intrinsics;
  double reach = 0;  ///< radians from the axis, up to which the photo shows the scene
};

/// Degrees from the axis that one pinhole view can still show: its pixels there are 30 times as wide as in its middle.
inline constexpr double kMaxFlatDegrees = 80;

/// The lens of a fisheye model whose image reaches beyond kMaxFlatDegrees, at its farthest corner or where the model
/// turns back; nullopt for all other cameras.
std::optional<FisheyeLens> WideFisheye(const Intrinsics& intrinsics);

/// Radians from the axis beyond which a photo of the lens's size is black, as the corners around an image circle are:
/// at most lens.reach, 0 for a black photo.
double LightReach(const Image8& photo, const FisheyeLens& lens);

}  // namespace oraclegs
