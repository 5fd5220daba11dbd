#pragma once
// The search for stereo's planes: one interface for every device.

#include <vector>

#include "oraclegs/depth/patch_match.h"

namespace oraclegs {

/// One pass over the maps of all views; the geometric term compares with the maps of the pass before.
struct SearchPass {
  int iterations = 3;
  int number = 0;          ///< below 63; no two of a run are the same
  bool geometric = false;  ///< views must agree with the others' maps as the pass before left them
  bool local = false;      ///< planes are near right: no far neighbors and no planes far from a pixel's own are tried
};

/// Holds the maps of one resolution at a time.
class PlaneSearch {
 public:
  virtual ~PlaneSearch() = default;

  /// Takes the maps of all views of the scene, which must live until EndLevel, and drops those of another level.
  virtual void BeginLevel(const StereoScene& scene, std::vector<PlaneMap> maps) = 0;
  virtual void BeginPass(const SearchPass& pass) = 0;
  /// Improves the map of one view, once in each pass; a view without neighbors stays as it is. Returns when it is
  /// done.
  virtual void Improve(size_t view) = 0;
  /// Gives the maps back.
  virtual std::vector<PlaneMap> EndLevel() = 0;
};

}  // namespace oraclegs
