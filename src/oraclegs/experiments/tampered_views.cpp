#include "oraclegs/experiments/tampered_views.h"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <optional>
#include <utility>

#include "oraclegs/core/interrupt.h"
#include "oraclegs/image/codecs.h"
#include "oraclegs/image/read_image.h"
#include "oraclegs/propose/proposal_files.h"

namespace oraclegs {
namespace {

namespace fs = std::filesystem;

constexpr size_t kMaxLies = 300;
constexpr uint8_t kYes = 255;

PixelMask Difference(const ImageF& image, const ImageF& honest) {
  PixelMask mask(image.data.size() / 3, 0);
  for (size_t i = 0; i < image.data.size(); ++i) {
    if (std::abs(image.data[i] - honest.data[i]) > kHonestDifference) mask[i / 3] = kYes;
  }
  return mask;
}

double ShareOf(const std::vector<PixelMask>& masks) {
  double pixels = 0, tampered = 0;
  for (const PixelMask& mask : masks) {
    pixels += static_cast<double>(mask.size());
    tampered += static_cast<double>(std::count(mask.begin(), mask.end(), kYes));
  }
  return pixels > 0 ? tampered / pixels : 0;
}

}  // namespace

ViewTamperer::ViewTamperer(const std::vector<ProxyModel>& members, RenderOptions render, std::vector<Target> targets,
                           uint64_t seed)
    : render_(std::move(render)), targets_(std::move(targets)) {
  const EnsembleProposer honest(members, render_);
  for (const Target& target : targets_) honest_.push_back(*honest.Propose(target, std::nullopt));
  lies_ = DrawGaussianTamperings(honest_, kMaxLies, seed);
  for (const ProxyModel& member : members) {
    models_.push_back(member.gaussians);
    members_.emplace_back(member.gaussians, lies_);
  }
}

TamperedViews ViewTamperer::Render(const std::vector<TamperedGaussians>& tampered, size_t lies) const {
  TamperedViews views;
  views.lies = lies;
  for (size_t v = 0; v < targets_.size(); ++v) {
    ThrowIfInterrupted();
    std::vector<ProxyModel> members;
    for (const TamperedGaussians& member : tampered) members.push_back({{}, member.Make(lies, v), {}});
    const EnsembleProposer ensemble(std::move(members), render_);
    views.proposals.push_back(*ensemble.Propose(targets_[v], std::nullopt));
    views.masks.push_back(Difference(views.proposals.back().rgb, honest_[v].rgb));
  }
  views.share = ShareOf(views.masks);
  return views;
}

std::vector<PixelKinds> ViewTamperer::KindsOf(size_t lies) const {
  std::vector<PixelKinds> kinds;
  for (const Proposal& p : honest_) kinds.emplace_back(p.rgb.data.size() / 3, 0);
  for (int kind = 0; kind < kGaussianTamperKinds; ++kind) {
    std::vector<GaussianTampering> of_kind;
    std::copy_if(lies_.begin(), lies_.begin() + static_cast<int64_t>(lies), std::back_inserter(of_kind),
                 [&](const GaussianTampering& lie) { return static_cast<int>(lie.kind) == kind; });
    if (of_kind.empty()) continue;
    std::vector<TamperedGaussians> members;
    for (const Gaussians& model : models_) members.emplace_back(model, of_kind);
    const TamperedViews views = Render(members, of_kind.size());
    for (size_t v = 0; v < kinds.size(); ++v) {
      for (size_t i = 0; i < kinds[v].size(); ++i) {
        if (views.masks[v][i] != 0) kinds[v][i] = static_cast<uint8_t>(kinds[v][i] | (1 << kind));
      }
    }
  }
  return kinds;
}

TamperedViews ViewTamperer::FewestThatReach(double share) const {
  const size_t most = lies_.size() - 1;
  // More tampered balls cost more to render, so the search begins with few.
  size_t too_few = 0, enough = std::min<size_t>(1, most);
  TamperedViews views = With(enough);
  while (views.share < share && enough < most) {
    too_few = enough;
    enough = std::min(2 * enough, most);
    views = With(enough);
  }
  while (too_few + 1 < enough) {
    const size_t middle = (too_few + enough) / 2;
    TamperedViews tried = With(middle);
    if (tried.share < share) {
      too_few = middle;
    } else {
      enough = middle;
      views = std::move(tried);
    }
  }
  return views;
}

TamperedViews ViewTamperer::Reach(double share) const {
  TamperedViews views = share <= 0 ? With(0) : share < 1 ? FewestThatReach(share) : With(lies_.size());
  views.kinds = KindsOf(views.lies);
  if (share >= 1) {
    for (PixelMask& mask : views.masks) std::fill(mask.begin(), mask.end(), kYes);
    views.share = 1;
  }
  return views;
}

void WriteMask(const fs::path& path, const PixelMask& mask, const Camera& camera) {
  WritePng(path, {camera.width, camera.height, 1, mask});
}

PixelMask ReadMask(const fs::path& path, const Camera& camera) {
  const Image8 image = ReadImage(path);
  if (image.width != camera.width || image.height != camera.height || image.channels != 3) {
    throw InputError("{}: is {} x {}, not {} x {}; delete it and run again", path.string(), image.width, image.height,
                     camera.width, camera.height);
  }
  PixelMask mask;
  for (size_t i = 0; i < image.data.size(); i += 3) mask.push_back(image.data[i]);
  return mask;
}

void WriteTamperedViews(const fs::path& dir, const TamperedViews& views, const Similarity& placement) {
  WriteProposals(dir / "pictures", views.proposals, placement);
  WriteProposals(dir / "ideal", views.proposals, placement);
  for (size_t v = 0; v < views.proposals.size(); ++v) {
    const Proposal& p = views.proposals[v];
    PixelMask trusted = views.masks[v];
    for (uint8_t& value : trusted) value = static_cast<uint8_t>(kYes - value);
    WriteMask(dir / "ideal" / "confidence" / (p.name + ".png"), trusted, p.camera);
    WriteMask(dir / "masks" / (p.name + ".png"), views.masks[v], p.camera);
    WriteMask(dir / "kinds" / (p.name + ".png"), views.kinds[v], p.camera);
  }
}

}  // namespace oraclegs
