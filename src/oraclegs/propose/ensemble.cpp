#include "oraclegs/propose/ensemble.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "oraclegs/core/parallel.h"
#include "oraclegs/render/render.h"

namespace oraclegs {
namespace {

constexpr float kMinAlphaForDepth = 0.5f;
constexpr size_t kMinValuesForTrim = 4;
constexpr int64_t kBlock = 4096;  // pixels

/// Render of one member.
struct Render {
  std::vector<float> rgb, inv_depth;
};

Render ToRender(const RenderOutput& out) {
  Render render;
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

/// Mean of the values, without the smallest and the largest where there are four or more.
float TrimmedMean(std::vector<float>* values) {
  std::sort(values->begin(), values->end());
  const size_t trim = values->size() >= kMinValuesForTrim ? 1 : 0;
  float sum = 0;
  for (size_t k = trim; k < values->size() - trim; ++k) sum += (*values)[k];
  return sum / static_cast<float>(values->size() - 2 * trim);
}

}  // namespace

EnsembleProposer::EnsembleProposer(std::vector<ProxyModel> members, RenderOptions render)
    : members_(std::move(members)), render_(std::move(render)), rasterizer_(MakeRasterizer(kCpu)) {}

std::optional<Proposal> EnsembleProposer::Propose(const Target& target, std::optional<int> held_out) const {
  std::vector<Render> renders;
  {
    const std::lock_guard<std::mutex> lock(mutex_);
    for (const ProxyModel& member : members_) {
      const std::vector<int>& unseen = member.held_out;
      if (held_out && std::find(unseen.begin(), unseen.end(), *held_out) == unseen.end()) continue;
      const Gaussians& gaussians = held_out ? member.before : member.gaussians;
      renders.push_back(ToRender(rasterizer_->Forward(gaussians, target.camera, render_, RenderPass::kInference)));
    }
  }
  if (renders.empty()) return std::nullopt;
  const size_t pixels = renders[0].inv_depth.size();
  Proposal proposal{target.name, name(), target.camera, {target.camera.width, target.camera.height, 3, {}}};
  proposal.rgb.data.resize(3 * pixels);
  proposal.inv_depth.resize(pixels);
  if (renders.size() > 1) proposal.spread.resize(pixels);
  ParallelBlocks(static_cast<int64_t>(pixels), kBlock, [&](int64_t begin, int64_t end) {
    std::vector<float> values(renders.size());
    for (auto i = static_cast<size_t>(begin); i < static_cast<size_t>(end); ++i) {
      float squares = 0;
      for (size_t c = 3 * i; c < 3 * i + 3; ++c) {
        for (size_t r = 0; r < renders.size(); ++r) values[r] = renders[r].rgb[c];
        const float mean = proposal.rgb.data[c] = TrimmedMean(&values);
        for (const float v : values) squares += (v - mean) * (v - mean);
      }
      if (!proposal.spread.empty()) proposal.spread[i] = std::sqrt(squares / static_cast<float>(3 * renders.size()));
      for (size_t r = 0; r < renders.size(); ++r) values[r] = renders[r].inv_depth[i];
      proposal.inv_depth[i] = TrimmedMean(&values);
    }
  });
  return proposal;
}

std::vector<int> HeldOutViews(int views, int members, int member) {
  std::vector<int> held_out;
  if (members < 2) return held_out;
  for (int v = member; v < views; v += members) held_out.push_back(v);
  return held_out;
}

}  // namespace oraclegs
