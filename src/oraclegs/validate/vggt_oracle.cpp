#include "oraclegs/validate/vggt_oracle.h"

#include <algorithm>

#include "oraclegs/core/interrupt.h"
#include "oraclegs/networks/vggt/input.h"
#include "oraclegs/validate/view_chunks.h"

namespace oraclegs {
namespace {

/// The photograph within `width` x `height` pixels, white around it: only its own patches, which no map is made of, are
/// then partly white.
Image8 Fitted(const Image8& photo, int width, int height) {
  if (photo.width == width && photo.height == height) return photo;
  const double scale = std::min(static_cast<double>(width) / photo.width, static_cast<double>(height) / photo.height);
  const int w = std::clamp(static_cast<int>(scale * photo.width), 1, width);
  const int h = std::clamp(static_cast<int>(scale * photo.height), 1, height);
  const Image8 small = ResizeLikePillow(photo, w, h);
  Image8 out{width, height, 3, std::vector<uint8_t>(size_t{3} * width * height, 255)};
  for (int y = 0; y < h; ++y) {
    const auto row = small.data.begin() + static_cast<int64_t>(y) * w * 3;
    std::copy(row, row + int64_t{3} * w,
              out.data.begin() + (static_cast<int64_t>(y + (height - h) / 2) * width + (width - w) / 2) * 3);
  }
  return out;
}

}  // namespace

VggtOracle::VggtOracle(Aggregator aggregator, VggtOracleOptions options, const std::vector<LoadedView>& photos)
    : aggregator_(std::move(aggregator)), options_(std::move(options)), photos_(photos) {
  if (options_.layers.empty() || options_.layers.size() != options_.weights.size() || options_.chunk == 0) {
    throw ShapeError("VggtOracle: {} layers, {} weights, chunks of {}", options_.layers.size(), options_.weights.size(),
                     options_.chunk);
  }
}

Tensor VggtOracle::Look(const Image8& photograph, const std::vector<Image8>& proposals) const {
  const int width = proposals[0].width, height = proposals[0].height;
  const bool official = options_.mode == AttentionMode::kOfficial;
  std::vector<Image8> views = {official ? photograph : Fitted(photograph, width, height)};
  views.insert(views.end(), proposals.begin(), proposals.end());
  const int64_t patch = aggregator_.config.backbone.patch;
  const VggtInput input = PrepareVggtInput(views, official ? VggtFit::kPad : VggtFit::kWhole, options_.side, patch);
  const AggregatorResult result =
      Aggregate(aggregator_, input.images.to(aggregator_.camera_token.device()), {{}, options_.layers});
  std::vector<WeightedAttention> layers;
  for (size_t l = 0; l < options_.layers.size(); ++l) {
    const GlobalAttention& on_device = result.attention.at(options_.layers[l]);
    layers.push_back(
        {{on_device.from_patches.to(torch::kCPU), on_device.from_camera.to(torch::kCPU)}, options_.weights[l]});
  }
  const int64_t rows = input.images.size(2), cols = input.images.size(3);
  const Tensor confidence =
      UpsampleConfidence(PatchConfidence(layers, options_.mode, {rows / patch, cols / patch}).slice(0, 1), rows, cols);
  const VggtInputPlace& place = input.places[1];  // all proposals have one size
  const Tensor shown = confidence.slice(1, place.top, place.top + place.height)
                           .slice(2, place.left, place.left + place.width)
                           .contiguous();
  return UpsampleConfidence(shown, height, width).clamp_(0, 1).contiguous();
}

std::vector<ConfidenceMap> VggtOracle::Judge(const std::vector<HiddenPhotograph>& hidden) const {
  std::vector<ConfidenceMap> maps(hidden.size());
  for (const ViewChunk& chunk : PlanChunks(hidden, photos_, options_.chunk)) {
    ThrowIfInterrupted();
    std::vector<Image8> proposals;
    for (const size_t m : chunk.members) proposals.push_back(ToImage8(hidden[m].proposal.rgb));
    const Tensor confidence = Look(ToImage8(photos_[chunk.reference].rgb), proposals);
    const auto pixels = static_cast<size_t>(confidence.size(1) * confidence.size(2));
    const float* values = confidence.data_ptr<float>();
    for (size_t i = 0; i < chunk.members.size(); ++i) {
      maps[chunk.members[i]].assign(values + i * pixels, values + (i + 1) * pixels);
    }
    if (options_.looked) options_.looked(chunk.members.size());
  }
  return maps;
}

}  // namespace oraclegs
