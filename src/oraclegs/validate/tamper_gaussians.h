#pragma once
// Models that lie in places: Gaussians that are tampered with inside balls, so that all views agree on the lie
// (docs/method.md#tampering-benchmark).

#include <Eigen/Core>
#include <array>
#include <cstdint>
#include <vector>

#include "oraclegs/gaussians/gaussians.h"
#include "oraclegs/propose/proposal.h"

namespace oraclegs {

/// What happens to the Gaussians in a ball.
enum class GaussianTamperKind {
  kDisplace,  ///< moved together, as of geometry that is wrong
  kSwap,      ///< replaced with those of another place
  kTone,      ///< colors through a random gain and offset of each channel
  kSmooth,    ///< half of them, three times as large, as of inpainting without detail
  kInvent,    ///< copies of another place stand in free space before the surface
  kDelete,    ///< removed
  kFlicker,   ///< moved and toned anew in each view, as of a generator without consistency
};
inline constexpr std::array kGaussianTamperKindNames = {"displace", "swap",   "tone",   "smooth",
                                                        "invent",   "delete", "flicker"};
inline constexpr int kGaussianTamperKinds = kGaussianTamperKindNames.size();

/// One lie. The same list, applied to all members of an ensemble, gives the mean of their renders the same lies.
struct GaussianTampering {
  GaussianTamperKind kind = GaussianTamperKind::kTone;
  Eigen::Vector3f center = {0, 0, 0};  ///< of the ball, world frame
  float radius = 0;                    ///< world units; infinite = all Gaussians
  float depth = 1;                     ///< of the surface in the view that the ball was drawn in, world units
  Eigen::Vector3f source = {0, 0, 0};  ///< center of the other place's ball, of swap and invent
  uint64_t seed = 0, number = 0;       ///< of the random numbers behind its displacement and tone
};

/// `count` lies at surfaces that the proposals show: ball centers are surface points under random pixels, radii
/// log-uniform in 4-20 % of the smaller image side there; the kinds have equal shares. After them a last one that tones
/// all Gaussians. `honest` are proposals with depth. Without any depth there is only the last one. The same arguments
/// give the same list, and a smaller count its beginning.
std::vector<GaussianTampering> DrawGaussianTamperings(const std::vector<Proposal>& honest, size_t count, uint64_t seed);

/// A model with the first few lies of a list.
class TamperedGaussians {
 public:
  /// Throws ShapeError for buffers that do not fit or lie on a GPU.
  TamperedGaussians(Gaussians honest, std::vector<GaussianTampering> tamperings);

  /// The model with the first `count` lies as view number `view` sees it. A Gaussian follows the first ball that its
  /// center lies in; one in no ball keeps its bits and its place in the order. What swap and invent add stands behind.
  Gaussians Make(size_t count, uint64_t view) const;

 private:
  Gaussians honest_;
  std::vector<GaussianTampering> tamperings_;
  std::vector<size_t> ball_;                   ///< of each Gaussian, the first one that it is in; past the end = none
  std::vector<std::vector<int64_t>> sources_;  ///< of each lie, the Gaussians of the other place
};

}  // namespace oraclegs
