#include "oraclegs/propose/ensemble.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <utility>

#include "oraclegs/render/make_rasterizer.h"

namespace oraclegs {
namespace {

constexpr float kMinAlphaForDepth = 0.5f;
constexpr size_t kMinValuesForTrim = 4;

/// What one member shows.
struct MemberRender {
  std::vector<float> rgb, inv_depth;
};

MemberRender ToRender(const RenderOutput& out) {
  MemberRender render;
  const float* image = out.image.data();
  const float* alpha = out.alpha.data();
  const float* inv_depth = out.inv_depth.data();
  render.rgb.resize(static_cast<size_t>(out.image.count()));
  std::transform(image, image + out.image.count(), render.rgb.begin(), [](float v) { return std::clamp(v, 0.f, 1.f); });
  for (int64_t i = 0; i < out.alpha.count(); ++i) {
    render.inv_depth.push_back(alpha[i] > kMinAlphaForDepth ? inv_depth[i] / alpha[i] : 0.f);
  }
  return render;
}

/// The mean of all, or of all but the smallest and the largest.
float TrimmedMean(std::vector<float>* values) {
  std::sort(values->begin(), values->end());
  const size_t trim = values->size() >= kMinValuesForTrim ? 1 : 0;
  float sum = 0;
  for (size_t k = trim; k < values->size() - trim; ++k) sum += (*values)[k];
  return sum / static_cast<float>(values->size() - 2 * trim);
}

/// Of each pixel of the same image in all renders.
std::vector<float> MeanOf(const std::vector<MemberRender>& renders, std::vector<float> MemberRender::*image) {
  std::vector<float> mean((renders[0].*image).size()), values(renders.size());
  for (size_t i = 0; i < mean.size(); ++i) {
    for (size_t r = 0; r < renders.size(); ++r) values[r] = (renders[r].*image)[i];
    mean[i] = TrimmedMean(&values);
  }
  return mean;
}

/// Sample deviation of the colours of each pixel, root mean square over the channels; of two renders or more.
std::vector<float> DeviationOf(const std::vector<MemberRender>& renders) {
  const auto n = static_cast<float>(renders.size());
  std::vector<float> deviation(renders[0].inv_depth.size());
  for (size_t i = 0; i < deviation.size(); ++i) {
    float squares = 0;
    for (size_t c = 3 * i; c < 3 * i + 3; ++c) {
      float mean = 0;
      for (const MemberRender& r : renders) mean += r.rgb[c] / n;
      for (const MemberRender& r : renders) squares += (r.rgb[c] - mean) * (r.rgb[c] - mean);
    }
    deviation[i] = std::sqrt(squares / (3 * (n - 1)));
  }
  return deviation;
}

/// From how many members a view is held out, of the view of which there are fewest.
int FewestLeaveOuts(const std::vector<ProxyModel>& members) {
  std::map<int, int> count;
  for (const ProxyModel& member : members) {
    for (const int view : member.held_out) ++count[view];
  }
  int fewest = count.empty() ? 0 : std::numeric_limits<int>::max();
  for (const auto& [view, models] : count) fewest = std::min(fewest, models);
  return fewest;
}

}  // namespace

EnsembleProposer::EnsembleProposer(std::vector<ProxyModel> members, RenderOptions render)
    : members_(std::move(members)),
      render_(std::move(render)),
      overlaps_(FewestLeaveOuts(members_) > 1),
      rasterizer_(MakeRasterizer(kCpu)) {}

std::optional<Proposal> EnsembleProposer::Propose(const Target& target, std::optional<int> held_out) const {
  std::vector<MemberRender> finished, leave_out;
  {
    const std::lock_guard<std::mutex> lock(mutex_);
    const auto render = [&](const Gaussians& gaussians) {
      return ToRender(rasterizer_->Forward(gaussians, target.camera, render_, RenderPass::kInference));
    };
    for (const ProxyModel& member : members_) {
      const std::vector<int>& unseen = member.held_out;
      const bool knows_it = held_out && std::find(unseen.begin(), unseen.end(), *held_out) == unseen.end();
      if (!knows_it && (held_out || overlaps_)) leave_out.push_back(render(member.before));
      if (!held_out && member.gaussians) finished.push_back(render(*member.gaussians));
    }
  }
  const std::vector<MemberRender>& shown = held_out ? leave_out : finished;
  if (shown.empty()) return std::nullopt;
  Proposal proposal{target.name, name(), target.camera, {target.camera.width, target.camera.height, 3, {}}};
  proposal.rgb.data = MeanOf(shown, &MemberRender::rgb);
  proposal.inv_depth = MeanOf(shown, &MemberRender::inv_depth);
  if (overlaps_ && leave_out.size() > 1) proposal.spread = DeviationOf(leave_out);
  return proposal;
}

std::vector<int> HeldOutViews(int views, int members, int member) {
  std::vector<int> held_out;
  if (members < 2) return held_out;
  const int from_each = views >= kMinViewsForOverlap ? members / 2 : 1;
  for (int v = 0; v < views; ++v) {
    if ((member - v % members + members) % members < from_each) held_out.push_back(v);
  }
  return held_out;
}

}  // namespace oraclegs
