#pragma once
// Interface of the search for stereo's planes on every device.

#include <memory>
#include <vector>

#include "oraclegs/core/buffer.h"
#include "oraclegs/depth/patch_match.h"

namespace oraclegs {

/// One pass over the maps of all views; the geometric term compares with the maps of the pass before.
struct SearchPass {
  int iterations = 3;
  int number = 0;          ///< unique in a run, below 63
  bool geometric = false;  ///< views must agree with the others' maps after the pass before
  bool local = false;      ///< planes are nearly right: far neighbors and planes far from a pixel's own are not tried
};

/// Holds the maps of one resolution at a time.
class PlaneSearch {
 public:
  virtual ~PlaneSearch() = default;

  /// Takes the maps of all views of the scene, which must live until EndLevel. Drops those of another level.
  virtual void BeginLevel(const StereoScene& scene, std::vector<PlaneMap> maps) = 0;
  virtual void BeginPass(const SearchPass& pass) = 0;
  /// Improves the map of one view, once in each pass; a view without neighbors is unchanged. Returns when done.
  virtual void Improve(size_t view) = 0;
  /// Returns the maps.
  virtual std::vector<PlaneMap> EndLevel() = 0;
};

/// Makes the search of a device. On the CPU it uses all threads, and any number of them gives the same bits. On a GPU
/// it is the same search with the same random numbers: equal up to rounding, and the same bits on the same GPU. Throws
/// UsageError when there is no such GPU, or no library of device code; on a GPU BeginLevel throws OutOfMemory.
std::unique_ptr<PlaneSearch> MakePlaneSearch(Device device);

}  // namespace oraclegs

namespace oraclegs::cuda {

/// Makes the search on a GPU; see MakePlaneSearch. From BeginLevel to EndLevel the GPU holds the images, maps and
/// silhouettes of a level: about 32 bytes a pixel, and 4 more for each channel.
std::unique_ptr<PlaneSearch> MakeCudaPlaneSearch(int index);

}  // namespace oraclegs::cuda
