#pragma once
// Forward warp of views into a new one by their stereo depth: the generator without weights
// (docs/method.md#warp-proposals).

#include <Eigen/Core>
#include <memory>
#include <optional>

#include "oraclegs/core/buffer.h"
#include "oraclegs/depth/nearest_sources.h"
#include "oraclegs/propose/proposal.h"
#include "oraclegs/propose/warp_device.h"

namespace oraclegs {

/// Warps into any view. Safe to call from several threads at once.
class Warper {
 public:
  /// Makes a warper that works on `device`. A GPU finds surfaces and colors, equal to the CPU's up to rounding; holes
  /// are filled on the CPU. Throws ShapeError for images of different sizes, and as MakeWarpDevice.
  explicit Warper(WarpSources sources, Device device = kCpu);
  /// Makes a warper on the caller's device, which must have these sources.
  Warper(WarpSources sources, std::unique_ptr<WarpDevice> device);
  ~Warper();

  /// The view from `camera`, without the training view of index `held_out`, whose image and depth count for nothing:
  /// not for the confidence of the others' depth either (ConfidenceWithout). Depths of the nearest views are splatted;
  /// each pixel takes the nearest surface with enough votes, and holes are filled from the farther surroundings. Colors
  /// come from the views that show that surface, those near the ray first. Without any depth in view the image has the
  /// background's color, and a ring of width + height everywhere.
  WarpedView Warp(const Camera& camera, std::optional<int> held_out = std::nullopt) const;

  /// Depth found by Warp before it fills holes and looks for colors.
  WarpDepth Surfaces(const Camera& camera) const;

  /// Exposure gain of a view, a divisor of its colors, per channel.
  Eigen::Vector3f Gain(size_t view) const {
    return sources_.gains.empty() ? Eigen::Vector3f::Ones() : sources_.gains[view];
  }

 private:
  void FindRange();
  WarpTask TaskOf(const Camera& camera, std::optional<int> held_out) const;

  WarpSources sources_;
  NearestSources nearest_sources_;
  std::unique_ptr<WarpDevice> device_;
  float nearest_ = 0, farthest_ = 0;  ///< range of the distances of known surfaces from the cameras
};

/// Proposer "warp": forward warps of the training views.
class WarpProposer : public Proposer {
 public:
  explicit WarpProposer(const Warper& warper) : warper_(warper) {}
  std::string name() const override { return "warp"; }
  std::optional<Proposal> Propose(const Target& target, std::optional<int> held_out) const override;

 private:
  const Warper& warper_;
};

}  // namespace oraclegs
