#pragma once
// A proposed view: a generator's prediction of what a camera would see where no image was taken.

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "oraclegs/camera/camera.h"
#include "oraclegs/image/image.h"

namespace oraclegs {

/// A pose for which proposals are made.
struct Target {
  std::string name;  ///< name of its files, without extension; unique within a run
  Camera camera;     ///< pinhole, at working resolution
};

/// Source of a mix of several candidates.
inline constexpr const char* kMixed = "mixed";

/// One candidate image for a target.
struct Proposal {
  std::string name;    ///< name of the target
  std::string source;  ///< the proposer: "warp", "proxies", "folder"
  Camera camera;
  ImageF rgb;                         ///< 3 channels, [0, 1], in the mean exposure of the training images
  std::vector<float> inv_depth = {};  ///< height * width, 1/world unit, 0 = unknown; empty = the proposer has none
  /// height * width: 1 + index of the training view a pixel's color comes from most, 0 = made up; empty = unknown.
  std::vector<uint16_t> provenance = {};
  std::vector<float> spread = {};  ///< height * width, RMS difference of color between the ensemble members or
                                   ///< candidates behind a pixel; empty = there is one
};

/// Makes candidate images. Safe to call from several threads at once.
class Proposer {
 public:
  virtual ~Proposer() = default;

  /// Word of --proposers, and source of its proposals.
  virtual std::string name() const = 0;

  /// Proposal for `target`, made without the training view of index `held_out`, or from all views. With a held-out view
  /// the target is that view's own camera, and the answer shows how wrong the proposer is where no image was taken:
  /// validation measures it. Stereo has used the held-out view; only its own depth map is left out. nullopt when the
  /// proposer has no answer, or cannot hold a view out.
  virtual std::optional<Proposal> Propose(const Target& target, std::optional<int> held_out) const = 0;
};

}  // namespace oraclegs
