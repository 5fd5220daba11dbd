#pragma once
// A patch of one view looked for in another image, to fractions of a pixel (docs/method.md#pose-refinement).

#include <Eigen/Core>
#include <array>
#include <optional>
#include <vector>

#include "oraclegs/depth/depth_map.h"
#include "oraclegs/depth/plane.h"
#include "oraclegs/image/image.h"

namespace oraclegs {

inline constexpr int kSearchRadius = 4;  ///< pixels: of a patch, at each resolution
inline constexpr int kSearchSide = 2 * kSearchRadius + 1;
inline constexpr int kSearchSamples = kSearchSide * kSearchSide;

/// A pixel with the plane through it.
struct OffsetPixel {
  int view = 0;
  float u = 0, v = 0;              ///< the pixel's center
  double inv_depth = 0;            ///< 1/world unit
  float slope_x = 0, slope_y = 0;  ///< relative change of the inverse depth per pixel to the right, downward
};

/// Brightness of an image in 8-bit units at full, half and quarter size, or fewer of a small image; smoothed, so that
/// bilinear samples of it are nearly unbiased.
std::vector<ImageF> SearchPyramid(const ImageF& rgb);

/// A pixel's patch at one resolution.
struct SearchPatch {
  std::array<float, kSearchSamples> value{};               ///< 8-bit units
  std::array<float, kSearchSamples> weight{};              ///< 1 on the pixel's plane, else 0
  std::array<Eigen::Vector2f, kSearchSamples> gradient{};  ///< by the view's pixels
  float total = 0;                                         ///< sum of the weights

  /// Whether most of it is on the plane.
  bool IsSurface() const;
  /// Whether its place can be found in both directions.
  bool HasTexture() const;
};
/// `map` is that of the pixel's view, `scale` a pixel of the image in pixels of the map.
SearchPatch SearchPatchAt(const ImageF& image, const DepthMap& map, const OffsetPixel& pixel,
                          const Eigen::Vector2f& scale);

/// Where a pixel's plane puts the samples of its patch in another image.
struct WarpedPatch {
  std::array<Eigen::Vector2f, kSearchSamples> at;
  Eigen::Matrix2f by_pixel;  ///< derivative at the center, by the view's pixels
};
/// `map` is that between the views at this resolution. Returns nullopt where the patch comes behind the other camera or
/// is seen from its back, four times as large or a quarter of its size.
std::optional<WarpedPatch> WarpPatch(const PixelMap& map, const OffsetPixel& pixel, const Eigen::Vector2f& scale);

/// The shift in pixels at which the image correlates best with the patch, sought from `start` up to 3 px from it by the
/// inverse compositional method [Baker 2004], up to gain and offset of brightness. Returns nullopt where the patch has
/// too little texture as the image shows it, leaves the image, or is not found.
std::optional<Eigen::Vector2f> FindPatch(const SearchPatch& patch, const WarpedPatch& warped, const ImageF& image,
                                         const Eigen::Vector2f& start);

}  // namespace oraclegs
