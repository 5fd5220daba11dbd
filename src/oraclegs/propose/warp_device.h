#pragma once
// Interface between the Warper, which plans a warp, and the device that works on its pixels.

#include <Eigen/Core>
#include <array>
#include <memory>
#include <vector>

#include "oraclegs/core/buffer.h"
#include "oraclegs/depth/depth_map.h"
#include "oraclegs/depth/silhouettes.h"
#include "oraclegs/propose/warp_math.h"
#include "oraclegs/scene/loaded_view.h"

namespace oraclegs {

/// Views and depth of a scene. The referenced objects must outlive the holder.
struct WarpSources {
  const std::vector<LoadedView>& views;
  const std::vector<DepthMap>& maps;            ///< depth maps of the views, in their order
  std::vector<Eigen::Vector3f> gains = {};      ///< exposure gains of the views, divisors of colors; empty = all 1
  const Silhouettes* silhouettes = nullptr;     ///< null or empty: no plain background
  std::array<float, 3> background = {0, 0, 0};  ///< color of pixels that no view's object covers
};

struct WarpedView {
  ImageF rgb;                    ///< without holes
  std::vector<float> inv_depth;  ///< without holes; 0 = background
  std::vector<PixelEvidence> evidence;
  std::vector<uint16_t> provenance;  ///< as in Proposal
};

/// Input of the warp of one view.
struct WarpTask {
  WarpScene scene;                  ///< without sources
  std::vector<WarpSource> sources;  ///< in the order of their numbers; images in the host's memory
  /// Confidence that stands in for that of each source's map, which it points to; empty: the maps' own.
  std::vector<std::vector<float>> confidence = {};
};

/// Depth of a new view's pixels before they have colors, row by row.
struct WarpDepth {
  std::vector<float> inv_depth;  ///< 0 = unknown
  std::vector<uint8_t> beside;   ///< 1 = the ray misses the object
};

/// Warps pixels. Safe to call from several threads at once.
class WarpDevice {
 public:
  virtual ~WarpDevice() = default;

  /// Splats the depths of all sources and takes, at each pixel, the nearest surface that enough of them vote for.
  virtual WarpDepth FindSurfaces(const WarpTask& task) = 0;

  /// Fills colors, evidence (except for rings) and provenance of `view`, which has room for them. Returns the weight of
  /// each color in PushPull.
  virtual std::vector<float> Shade(const WarpTask& task, const WarpDepth& depth, WarpedView* view) = 0;
};

/// Makes the warp device of that name; `sources` must outlive it. On a GPU, which becomes the current one, it keeps a
/// copy of all images. Throws UsageError for a device this build cannot use, OutOfMemory.
std::unique_ptr<WarpDevice> MakeWarpDevice(Device device, const WarpSources& sources);

}  // namespace oraclegs

namespace oraclegs::cuda {

/// Samples (8 bytes each) of a new view that are listed at once; about as many as a dozen images of a million pixels
/// have.
inline constexpr int64_t kListedSamples = int64_t{1} << 25;

/// Makes the device that warps on GPU `index`. It keeps the images and their depth there (about 22 bytes a pixel) and
/// warps one view at a time, while other threads fill holes. A view takes another 70 bytes a pixel and the listed
/// samples, at least those of a single pixel. Memory for a view of the images' size is allocated here, since networks
/// that run between two views keep free memory. Throws UsageError when there is no such GPU, OutOfMemory.
std::unique_ptr<WarpDevice> MakeCudaWarpDevice(const WarpSources& sources, int index,
                                               int64_t listed_samples = kListedSamples);

}  // namespace oraclegs::cuda
