#include "oraclegs/propose/ensemble.h"

#include <algorithm>
#include <cmath>
#include <utility>

namespace oraclegs {
namespace {

constexpr float kOpaque = 0.5f;  // less alpha says nothing of depth
constexpr size_t kTrimFrom = 4;  // values

/// One opinion's picture.
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
    render.inv_depth.push_back(alpha[i] > kOpaque ? inv_depth[i] / alpha[i] : 0.f);
  }
  return render;
}

/// The mean of all, or of all but the smallest and the largest.
float TrimmedMean(std::vector<float>* values) {
  std::sort(values->begin(), values->end());
  const size_t trim = values->size() >= kTrimFrom ? 1 : 0;
  float sum = 0;
  for (size_t k = trim; k < values->size() - trim; ++k) sum += (*values)[k];
  return sum / static_cast<float>(values->size() - 2 * trim);
}

}  // namespace

EnsembleProposer::EnsembleProposer(std::vector<ProxyModel> opinions, RenderOptions render)
    : opinions_(std::move(opinions)), render_(std::move(render)), rasterizer_(MakeRasterizer(kCpu)) {}

std::optional<Proposal> EnsembleProposer::Propose(const Target& target, int hidden) const {
  std::vector<Render> renders;
  {
    const std::lock_guard<std::mutex> lock(mutex_);
    for (const ProxyModel& opinion : opinions_) {
      const bool unseen = std::find(opinion.unseen.begin(), opinion.unseen.end(), hidden) != opinion.unseen.end();
      if (hidden >= 0 && !unseen) continue;
      const Gaussians& gaussians = hidden >= 0 ? opinion.before : opinion.gaussians;
      renders.push_back(ToRender(rasterizer_->Forward(gaussians, target.camera, render_, RenderPass::kInference)));
    }
  }
  if (renders.empty()) return std::nullopt;
  const size_t pixels = renders[0].inv_depth.size();
  Proposal proposal{target.name, name(), target.camera, {target.camera.width, target.camera.height, 3, {}}};
  proposal.rgb.data.resize(3 * pixels);
  proposal.inv_depth.resize(pixels);
  if (renders.size() > 1) proposal.spread.resize(pixels);
  std::vector<float> values(renders.size());
  for (size_t i = 0; i < pixels; ++i) {
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
  return proposal;
}

std::vector<int> LeftOut(int photographs, int opinions, int k) {
  std::vector<int> left_out;
  if (opinions < 2) return left_out;
  for (int v = k; v < photographs; v += opinions) left_out.push_back(v);
  return left_out;
}

}  // namespace oraclegs
