#pragma once
// Proposals with a known share of wrong pixels: renders of an ensemble whose members are all tampered with in one way.

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

/// Mask of height * width pixels; 255 = yes, 0 = no.
using PixelMask = std::vector<uint8_t>;
/// Bits of height * width pixels; bit k = tampering of GaussianTamperKind k changes the pixel by itself.
using PixelKinds = std::vector<uint8_t>;

struct TamperedViews {
  size_t lies = 0;                  ///< number of tampered balls
  double share = 0;                 ///< tampered share of all proposals' pixels, [0, 1]
  std::vector<Proposal> proposals;  ///< one for each target, in their order
  std::vector<PixelMask> masks =
      {};  ///< one for each proposal: pixels that differ from the honest ones by more than kHonestDifference
  std::vector<PixelKinds> kinds = {};  ///< one for each proposal
};

class ViewTamperer {
 public:
  /// Needs members with Gaussians on the CPU, at least one member and one target. The seed decides what is tampered
  /// with.
  ViewTamperer(const std::vector<ProxyModel>& members, RenderOptions render, std::vector<Target> targets,
               uint64_t seed);

  /// Untouched renders of the members, with depth.
  const std::vector<Proposal>& honest() const { return honest_; }

  /// Views with the fewest tampered balls, in the order in which they were drawn, that reach the share, [0, 1]. Share 0
  /// has none; with share 1 everything is tampered with, and the masks hold all pixels. Where all balls together do not
  /// reach the share, `share` of the result is smaller. Throws Interrupted.
  TamperedViews Reach(double share) const;

 private:
  TamperedViews With(size_t lies) const { return Render(members_, lies); }
  TamperedViews Render(const std::vector<TamperedGaussians>& members, size_t lies) const;
  std::vector<PixelKinds> KindsOf(size_t lies) const;
  TamperedViews FewestThatReach(double share) const;

  RenderOptions render_;
  std::vector<Target> targets_;
  std::vector<Proposal> honest_;
  std::vector<GaussianTampering> lies_;  ///< the last one tampers with everything
  std::vector<Gaussians> models_;
  std::vector<TamperedGaussians> members_;
};

/// Writes dir/pictures/ and dir/ideal/, each a folder for --proposal-folder. The second has the confidence of an ideal
/// oracle (0 in the mask, 1 outside). Also writes dir/masks/NAME.png (255 = tampered) and dir/kinds/NAME.png
/// (PixelKinds). Poses are moved by `placement`.
void WriteTamperedViews(const std::filesystem::path& dir, const TamperedViews& views, const Similarity& placement = {});

/// Writes a mask of `camera`'s size. Throws RunError.
void WriteMask(const std::filesystem::path& path, const PixelMask& mask, const Camera& camera);

/// Reads an image of one gray channel and this size, [0, 255]. Throws InputError.
PixelMask ReadMask(const std::filesystem::path& path, const Camera& camera);

}  // namespace oraclegs
