#pragma once
// Google's photo sphere metadata (XMP, namespace GPano), which 360 degree cameras and stitching programs write.

#include <string_view>

namespace oraclegs {

/// The projection of a photo, as its metadata says it.
enum class Projection {
  kPlain,     ///< nothing is said: a photo through a lens
  kSphere,    ///< equirectangular and whole: 360 degrees across, 180 down
  kPanorama,  ///< a part of a sphere, a cylinder, or another projection
};

/// Reads the text of GPano:ProjectionType, and whether GPano:CroppedArea... is all of GPano:FullPano..., wherever they
/// stand in `head`, the first bytes of an image file: as attributes or as elements. What is damaged or not a number
/// makes it a kPanorama. https://developers.google.com/streetview/spherical-metadata
Projection ReadProjection(std::string_view head);

}  // namespace oraclegs
