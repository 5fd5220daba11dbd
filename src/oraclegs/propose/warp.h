#pragma once
// Forward warp of views into a new one by their stereo depth: the generator that needs no weights
// (docs/method.md#warp-proposals).

#include <Eigen/Core>
#include <memory>
#include <optional>

#include "oraclegs/core/device.h"
#include "oraclegs/propose/proposal.h"
#include "oraclegs/propose/warp_device.h"

namespace oraclegs {

/// Warps into any view. Safe to call from several threads at once.
class Warper {
 public:
  /// Works on `device`. On a GPU, surfaces and colors are found there and equal the CPU's up to rounding; holes are
  /// filled on the CPU. Throws ShapeError for images of different sizes, and as MakeWarpDevice.
  explicit Warper(WarpSources sources, Device device = kCpu);
  /// The same on a device of the caller's, which has the same sources.
  Warper(WarpSources sources, std::unique_ptr<WarpDevice> device);
  ~Warper();

  /// The view from `camera`, without the training view of index `held_out`. Depths of all views are splatted; at each
  /// pixel the nearest surface with enough votes is taken, and missing ones are filled from the farther surroundings.
  /// Colors come from the views that show that surface, those taken from near the ray first. Without any depth in
  /// view the image has the background's color, and a ring of width + height everywhere.
  WarpedView Warp(const Camera& camera, std::optional<int> held_out = std::nullopt) const;

  /// What Warp knows of the depth before it fills holes and looks for colors.
  WarpDepth Surfaces(const Camera& camera) const;

  /// The exposure that colors of a view are divided by, per channel.
  Eigen::Vector3f Gain(size_t view) const {
    return sources_.gains.empty() ? Eigen::Vector3f::Ones() : sources_.gains[view];
  }

 private:
  void FindRange();
  WarpTask TaskOf(const Camera& camera, std::optional<int> held_out) const;

  WarpSources sources_;
  std::unique_ptr<WarpDevice> device_;
  float nearest_ = 0, farthest_ = 0;  ///< distances of the known surfaces from the cameras
};

/// Proposer "warp".
class WarpProposer : public Proposer {
 public:
  explicit WarpProposer(const Warper& warper) : warper_(warper) {}
  std::string name() const override { return "warp"; }
  std::optional<Proposal> Propose(const Target& target, std::optional<int> held_out) const override;

 private:
  const Warper& warper_;
};

}  // namespace oraclegs
