#pragma once
// Models whose Gaussians are tampered with inside balls, so that all views agree on the error
// (docs/method.md#tampering-benchmark).

#include <Eigen/Core>
#include <array>
#include <cstdint>
#include <vector>

#include "oraclegs/gaussians/gaussians.h"
#include "oraclegs/propose/proposal.h"

namespace oraclegs {

/// Kinds of tampering with the Gaussians in a ball.
enum class GaussianTamperKind {
  kDisplace,  ///< moved together, as with wrong geometry
  kSwap,      ///< replaced by those of another place
  kTone,      ///< colors through a random gain and offset of each channel
  kSmooth,    ///< half of them, three times as large, as with inpainting without detail
  kInvent,    ///< copies of another place in free space before the surface
  kDelete,    ///< removed
  kFlicker,   ///< moved and toned differently in each view, as by an inconsistent generator
};
inline constexpr std::array kGaussianTamperKindNames = {"displace", "swap",   "tone",   "smooth",
                                                        "invent",   "delete", "flicker"};
inline constexpr int kGaussianTamperKinds = kGaussianTamperKindNames.size();

/// One tampering. A list of them, applied to all members of an ensemble, tampers with the mean of their renders.
struct GaussianTampering {
  GaussianTamperKind kind = GaussianTamperKind::kTone;
  Eigen::Vector3f center = {0, 0, 0};  ///< center of the ball, world frame
  float radius = 0;                    ///< world units; infinite = all Gaussians
  float depth = 1;                     ///< depth of the surface in the view that the ball was drawn in, world units
  Eigen::Vector3f source = {0, 0, 0};  ///< center of the other place's ball, for kSwap and kInvent
  uint64_t seed = 0, number = 0;       ///< identify the random numbers for its displacement and tone
};

/// Draws `count` tamperings at surfaces that the proposals show: ball centers are surface points under random pixels,
/// radii log-uniform in 4-20 % of the smaller image side there; the kinds have equal shares. A last one, which tones
/// all Gaussians, follows. `honest` are proposals with depth; without any depth there is only the last one. Equal
/// arguments give equal lists, and a smaller count the beginning of the list.
std::vector<GaussianTampering> DrawGaussianTamperings(const std::vector<Proposal>& honest, size_t count, uint64_t seed);

/// Model with the first few tamperings of a list.
class TamperedGaussians {
 public:
  /// Throws ShapeError for buffers that do not fit or lie on a GPU.
  TamperedGaussians(Gaussians honest, std::vector<GaussianTampering> tamperings);

  /// Model with the first `count` tamperings, as view number `view` sees it. A Gaussian follows the first ball that
  /// contains its center; one in no ball keeps its bits and its place in the order. Gaussians that kSwap and kInvent
  /// add come last.
  Gaussians Make(size_t count, uint64_t view) const;

 private:
  Gaussians honest_;
  std::vector<GaussianTampering> tamperings_;
  std::vector<size_t> ball_;                   ///< first ball that contains each Gaussian; past the end = none
  std::vector<std::vector<int64_t>> sources_;  ///< Gaussians of the other place, for each tampering
};

}  // namespace oraclegs
