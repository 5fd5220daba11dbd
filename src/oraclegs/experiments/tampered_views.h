#pragma once
// Proposals of which a known share of the pixels lies: renders of an ensemble whose members are tampered with alike.

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "oraclegs/camera/similarity.h"
#include "oraclegs/propose/ensemble.h"
#include "oraclegs/validate/tamper_gaussians.h"

namespace oraclegs {

/// Largest difference of a channel, in [0, 1], up to which a pixel counts as honest.
inline constexpr float kHonestDifference = 0.05f;

/// height * width, 255 = yes, 0 = no.
using PixelMask = std::vector<uint8_t>;
/// height * width, bit k = a lie of GaussianTamperKind k makes the difference by itself.
using PixelKinds = std::vector<uint8_t>;

struct TamperedViews {
  size_t lies = 0;                     ///< how many tampered balls there are
  double share = 0;                    ///< of all proposals' pixels, [0, 1]
  std::vector<Proposal> proposals;     ///< of the targets, in their order
  std::vector<PixelMask> masks = {};   ///< of each: where it differs from the honest one by more than kHonestDifference
  std::vector<PixelKinds> kinds = {};  ///< of each
};

class ViewTamperer {
 public:
  /// Members with Gaussians on the CPU; at least one member and one target. The same seed gives the same lies.
  ViewTamperer(const std::vector<ProxyModel>& members, RenderOptions render, std::vector<Target> targets,
               uint64_t seed);

  /// What the members show untouched, with depth.
  const std::vector<Proposal>& honest() const { return honest_; }

  /// With the fewest lies, in the order that they were drawn in, that reach the share, [0, 1]; of 0 there is none. Of 1
  /// everything is tampered with, and all pixels are in the masks. What all balls together do not reach is left, so
  /// that `share` is smaller. Throws Interrupted.
  TamperedViews Reach(double share) const;

 private:
  TamperedViews With(size_t lies) const { return Render(members_, lies); }
  TamperedViews Render(const std::vector<TamperedGaussians>& members, size_t lies) const;
  std::vector<PixelKinds> KindsOf(size_t lies) const;
  TamperedViews FewestThatReach(double share) const;

  RenderOptions render_;
  std::vector<Target> targets_;
  std::vector<Proposal> honest_;
  std::vector<GaussianTampering> lies_;  ///< the last one is of everything
  std::vector<Gaussians> models_;
  std::vector<TamperedGaussians> members_;
};

/// Writes dir/pictures/ and dir/ideal/, each a folder for --proposal-folder, the second with the confidence of an ideal
/// oracle (0 in the mask, 1 outside), dir/masks/NAME.png (255 = tampered) and dir/kinds/NAME.png (PixelKinds). Poses
/// are moved by `placement`.
void WriteTamperedViews(const std::filesystem::path& dir, const TamperedViews& views, const Similarity& placement = {});

/// Writes a mask of `camera`'s size. Throws RunError.
void WriteMask(const std::filesystem::path& path, const PixelMask& mask, const Camera& camera);

/// Reads an image of one gray channel and this size, [0, 255]. Throws InputError.
PixelMask ReadMask(const std::filesystem::path& path, const Camera& camera);

}  // namespace oraclegs
