#include "oraclegs/validate/vggt_oracle.h"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <utility>

#include "oraclegs/core/interrupt.h"
#include "oraclegs/core/text.h"
#include "oraclegs/validate/view_chunks.h"

namespace oraclegs {
namespace {

ConfidenceMap MapOf(const Buffer<float>& map) { return {map.span().begin(), map.span().end()}; }

constexpr const char* kLayers = "vggt-layers";
constexpr const char* kWeights = "vggt-layer-weights";

/// Numbers in a text like "0, 22". `kind` names in messages what each must be.
template <class T>
std::vector<T> NumbersOf(const char* option, const std::string& text, const char* kind) {
  std::vector<T> numbers;
  for (const std::string& word : SplitTrimmed(text, ',')) {
    T number{};
    const auto [end, error] = std::from_chars(word.data(), word.data() + word.size(), number);
    const bool whole_word = error == std::errc() && end == word.data() + word.size();
    if (!whole_word || !std::isfinite(static_cast<double>(number)) || number < 0) {
      throw UsageError(
          "--set {}: '{}' is not {}; write for example --set vggt-layers=0,22 --set vggt-layer-weights=1,3", option,
          Printable(word), kind);
    }
    numbers.push_back(number);
  }
  return numbers;
}

}  // namespace

VggtOracle::VggtOracle(std::unique_ptr<AttentionNetwork> network, VggtOracleOptions options,
                       const std::vector<LoadedView>& views)
    : network_(std::move(network)), options_(std::move(options)), views_(views) {
  if (options_.chunk == 0) throw ShapeError("VggtOracle: chunks of no proposal");
}

std::vector<ConfidenceMap> VggtOracle::Predict(const std::vector<Query>& queries) const {
  return options_.pass == OraclePass::kAll ? PredictShuffled(queries) : PredictChunks(queries);
}

std::vector<ConfidenceMap> VggtOracle::PredictChunks(const std::vector<Query>& queries) const {
  std::vector<ConfidenceMap> maps(queries.size());
  for (const ViewChunk& chunk : PlanChunks(queries, views_, options_.chunk)) {
    ThrowIfInterrupted();
    std::vector<Image8> images = {ToImage8(views_[chunk.reference].rgb)};
    std::vector<size_t> asked;
    for (const size_t m : chunk.members) {
      asked.push_back(images.size());
      images.push_back(ToImage8(queries[m].proposal.rgb));
    }
    const std::vector<Buffer<float>> answers = network_->Confidence(images, asked);
    for (size_t i = 0; i < answers.size(); ++i) maps[chunk.members[i]] = MapOf(answers[i]);
    if (options_.on_pass) options_.on_pass(chunk.members.size());
  }
  return maps;
}

std::vector<ConfidenceMap> VggtOracle::PredictShuffled(const std::vector<Query>& queries) const {
  for (const Query& query : queries) {
    if (query.held_out) throw ShapeError("{}: no view is held out of a pass over all", query.proposal.name);
  }
  std::vector<ConfidenceMap> maps(queries.size());
  if (queries.empty()) return maps;
  for (const std::vector<size_t>& run : ShuffledRuns(views_.size() + queries.size(), options_.chunk, options_.seed)) {
    ThrowIfInterrupted();
    std::vector<Image8> images;
    std::vector<size_t> asked, places;
    for (const size_t number : run) {
      if (number >= views_.size()) {
        asked.push_back(images.size());
        places.push_back(number - views_.size());
      }
      images.push_back(
          ToImage8(number < views_.size() ? views_[number].rgb : queries[number - views_.size()].proposal.rgb));
    }
    if (asked.empty()) continue;
    const std::vector<Buffer<float>> answers = network_->Confidence(images, asked);
    for (size_t i = 0; i < answers.size(); ++i) maps[places[i]] = MapOf(answers[i]);
    if (options_.on_pass) options_.on_pass(asked.size());
  }
  return maps;
}

std::vector<LayerWeight> AttentionLayersOf(const ValidateOptions& options) {
  const auto layers = NumbersOf<int64_t>(kLayers, options.vggt_layers, "the number of a layer, from 0");
  auto weights = NumbersOf<double>(kWeights, options.vggt_layer_weights, "a weight, a number from 0");
  if (layers.empty()) {
    if (!weights.empty())
      throw UsageError("--set {} needs --set {}: name the layers that the weights are of", kWeights, kLayers);
    return {};
  }
  if (weights.empty()) weights.assign(layers.size(), 1);
  if (weights.size() != layers.size()) {
    throw UsageError("--set {} names {} layers, --set {} {}: give each layer one weight", kLayers, layers.size(),
                     kWeights, weights.size());
  }
  double sum = 0;
  std::vector<LayerWeight> combined;
  for (size_t i = 0; i < layers.size(); ++i) {
    if (std::count(layers.begin(), layers.end(), layers[i]) > 1) {
      throw UsageError("--set {} names layer {} more than once", kLayers, layers[i]);
    }
    combined.push_back({layers[i], weights[i]});
    sum += weights[i];
  }
  if (!(sum > 0) || !std::isfinite(sum)) {
    throw UsageError("--set {}: the weights sum to {}; at least one must be above 0", kWeights, sum);
  }
  for (LayerWeight& layer : combined) layer.weight /= sum;
  return combined;
}

void RequireAttentionLayers(const std::vector<LayerWeight>& layers, int64_t depth, const std::string& network) {
  for (const LayerWeight& layer : layers) {
    if (layer.layer < depth) continue;
    throw UsageError("--set {} names layer {}; {} has the layers 0 to {}", kLayers, layer.layer, network, depth - 1);
  }
}

}  // namespace oraclegs
