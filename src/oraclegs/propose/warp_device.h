#pragma once
// The seam between what decides how a view is warped (Warper) and what works on its pixels.


#include <memory>
#include <vector>

#include "oraclegs/propose/warp.h"
#include "oraclegs/propose/warp_math.h"

namespace oraclegs {

/// One view to be warped.
struct WarpTask {
  WarpScene scene;                  ///< without sources
  std::vector<WarpSource> sources;  ///< in the order of their numbers; pictures in the host's memory
};

/// What is known of a new view's pixels before they have colours, row by row.
struct WarpDepth {
  std::vector<float> inv_depth;  ///< 0 = unknown
  std::vector<uint8_t> beside;   ///< 1 = the ray misses the object
};

/// Safe to call from several threads at once.
class WarpDevice {
 public:
  virtual ~WarpDevice() = default;

  /// Splats the depths of all sources and takes, at each pixel, the nearest surface that enough of them vote for.
  virtual WarpDepth FindSurfaces(const WarpTask& task) = 0;

  /// The colours, evidence (but for rings) and provenance of `view`, which has room for them, and how far each colour
  /// is known, for PushPull.
  virtual std::vector<float> Shade(const WarpTask& task, const WarpDepth& depth, WarpedView* view) = 0;
};

/// What works on the named device; `sources` must outlive it. On a GPU, which becomes the current one, it keeps a copy
/// of all pictures. Throws UsageError for a device this build cannot use, OutOfMemory.
std::unique_ptr<WarpDevice> MakeWarpDevice(Device device, const WarpSources& sources);

}  // namespace oraclegs
