#include "oraclegs/validate/attention_layers.h"

#include <algorithm>
#include <charconv>
#include <cmath>

#include "oraclegs/core/text.h"

namespace oraclegs {
namespace {

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
