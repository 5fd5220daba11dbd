#pragma once
// Interface of the search for stereo's planes on every device.

#include <vector>

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

}  // namespace oraclegs
