#pragma once
// Where stereo's planes are searched: one seam for every device.

#include <vector>

#include "oraclegs/depth/patch_match.h"

namespace oraclegs {

/// What all views' maps go through before any is compared with the new ones.
struct SearchPass {
  int iterations = 3;
  int number = 0;          ///< below 63; no two of a run are the same
  bool geometric = false;  ///< views must agree with the others' maps as the pass before left them
};

/// Holds the maps of one resolution at a time.
class PlaneSearch {
 public:
  virtual ~PlaneSearch() = default;

  /// Takes the maps of all views of the scene, which must live until EndLevel; what is left of another level is
  /// dropped.
  virtual void BeginLevel(const StereoScene& scene, std::vector<PlaneMap> maps) = 0;
  virtual void BeginPass(const SearchPass& pass) = 0;
  /// Improves the map of one view, once in each pass; a view without neighbours stays as it is. Comes back when it is
  /// done.
  virtual void Improve(size_t view) = 0;
  /// Gives the maps back.
  virtual std::vector<PlaneMap> EndLevel() = 0;
};

}  // namespace oraclegs
