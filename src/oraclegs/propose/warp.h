#pragma once
// Forward warp of photographs into a new view by their stereo depth: the generator that needs no weights
// (spec/weight_free.md, "Warp").

#include <Eigen/Core>
#include <array>
#include <vector>

#include "oraclegs/depth/depth_map.h"
#include "oraclegs/depth/plane.h"
#include "oraclegs/depth/silhouettes.h"
#include "oraclegs/propose/proposer.h"
#include "oraclegs/scene/photos.h"

namespace oraclegs {

/// What the photographs know of a scene. The referenced objects must outlive whoever holds this.
struct WarpSources {
  const std::vector<Photo>& photos;
  const std::vector<DepthMap>& maps;            ///< of the photographs, one by one
  std::vector<Eigen::Vector3f> gains = {};      ///< their exposures, which colours are freed of; empty = all 1
  const Silhouettes* silhouettes = nullptr;     ///< null or empty: no plain background
  std::array<float, 3> background = {0, 0, 0};  ///< colour of what no photograph's object covers
};

/// How a warped pixel is known.
struct PixelEvidence {
  float support = 0;     ///< sum over the photographs that show the point of (0.1 + confidence), nearer ones more
  float views = 0;       ///< how many show it
  float angle = 90;      ///< degrees between the ray and that of the nearest photograph that shows the point; 90 = none
  float spread = 0;      ///< RMS difference of the photographs' colours there
  float confidence = 0;  ///< of the depth, in the photograph that is surest
  float conflicts = 0;   ///< summed confidence of photographs that look through the point
  float hidden = 0;      ///< the same of those in which something stands before it
  float ring = 0;        ///< pixels to the nearest one whose depth was warped, 0 for those
  float resolution = 0;  ///< pixels of the best photograph in one pixel, per axis, at most 1
  float background = 0;  ///< 1 = the ray misses the object
};

struct WarpedView {
  ImageF rgb;                    ///< whole: holes are filled
  std::vector<float> inv_depth;  ///< whole; 0 = background
  std::vector<PixelEvidence> evidence;
  std::vector<uint16_t> provenance;  ///< as in Proposal
};

/// Warps into any view. Safe to call from several threads at once.
class Warper {
 public:
  explicit Warper(WarpSources sources);

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
  struct Samples;
  struct Geometry;
  Samples Splat(const Camera& camera, int hidden) const;
  float Surface(const Camera& camera, const Geometry& geometry, size_t pixel, const Samples& samples) const;
  bool MissesObject(const Geometry& geometry, float u, float v) const;
  void Shade(const Camera& camera, const Geometry& geometry, WarpedView* view, std::vector<float>* known) const;

  WarpSources sources_;
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
