#pragma once
// Forward warp of photographs into a new view by their stereo depth: the generator that needs no weights
// (spec/weight_free.md, "Warp").


#include <Eigen/Core>
#include <array>
#include <memory>
#include <vector>

#include "oraclegs/depth/depth_map.h"
#include "oraclegs/depth/silhouettes.h"
#include "oraclegs/propose/pixel_evidence.h"
#include "oraclegs/propose/proposer.h"
#include "oraclegs/scene/loaded_view.h"

namespace oraclegs {

/// What the photographs know of a scene. The referenced objects must outlive whoever holds this.
struct WarpSources {
  const std::vector<LoadedView>& photos;
  const std::vector<DepthMap>& maps;            ///< of the photographs, one by one
  std::vector<Eigen::Vector3f> gains = {};      ///< their exposures, which colours are freed of; empty = all 1
  const Silhouettes* silhouettes = nullptr;     ///< null or empty: no plain background
  std::array<float, 3> background = {0, 0, 0};  ///< colour of what no photograph's object covers
};

struct WarpedView {
  ImageF rgb;                    ///< whole: holes are filled
  std::vector<float> inv_depth;  ///< whole; 0 = background
  std::vector<PixelEvidence> evidence;
  std::vector<uint16_t> provenance;  ///< as in Proposal
};

class WarpDevice;

/// Warps into any view. Safe to call from several threads at once.
class Warper {
 public:
  /// Works on `device`: on a GPU surfaces and colours, to the CPU's but for rounding, while holes are filled on the
  /// CPU. Throws ShapeError for pictures of different sizes, and as MakeWarpDevice (warp_device.h).
  explicit Warper(WarpSources sources, Device device = kCpu);
  /// The same on a device of the caller's, which knows the same sources.
  Warper(WarpSources sources, std::unique_ptr<WarpDevice> device);
  ~Warper();

  /// The view from `camera`, without photograph `hidden` (-1: with all). Depths of all photographs are splatted; at
  /// each pixel the nearest surface that enough of them vote for is taken, what is missing filled from the farther
  /// surroundings; colours come from the photographs that show that surface, those taken from near the ray before
  /// others. Without any depth in view the picture is the background's colour, with a ring of width + height
  /// everywhere.
  WarpedView Warp(const Camera& camera, int hidden) const;

  /// The exposure that colours of a photograph are freed of, per channel.
  Eigen::Vector3f Gain(size_t photograph) const {
    return sources_.gains.empty() ? Eigen::Vector3f::Ones() : sources_.gains[photograph];
  }

 private:
  void FindRange();

  WarpSources sources_;
  std::unique_ptr<WarpDevice> device_;
  float nearest_ = 0, farthest_ = 0;  ///< distances of the known surfaces from the cameras
};

/// Proposer "warp".
class WarpProposer : public Proposer {
 public:
  explicit WarpProposer(const Warper& warper) : warper_(warper) {}
  std::string name() const override { return "warp"; }
  std::optional<Proposal> Propose(const Target& target, int hidden) const override;

 private:
  const Warper& warper_;
};

}  // namespace oraclegs
