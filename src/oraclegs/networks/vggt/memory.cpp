#include "oraclegs/networks/vggt/memory.h"

#include <algorithm>

namespace oraclegs::vggt {
namespace {

constexpr int64_t kFloat = 4;
// Widths a token inside a block: its input, queries, keys and values before and after norm and rotation, and their
// copies for the product; or the wide layer of the MLP with its input and output. The input of the frame block stays.
constexpr int64_t kWidthsInBlock = 16;
constexpr int64_t kWidthsKept = 2;                   // for a layer that the heads read
constexpr int64_t kBytesOnTop = int64_t{256} << 20;  // scores in work, buffers of the libraries

/// Bytes of the depth head, which works view by view: maps of 8x the grid with all features, then of the image's size
/// with half of them, with the unrolled input of a convolution.
int64_t DenseBytes(const Config& config, const Pass& pass) {
  const int64_t patch = config.aggregator.backbone.patch, features = config.dense.features;
  const int64_t fine = 64 * (pass.height / patch) * (pass.width / patch), pixels = pass.height * pass.width;
  const int64_t fusing = 5 * features * fine, shown = 5 * (features / 2) * pixels;
  return kFloat * (std::max(fusing, shown) + 4 * pass.views * pixels);
}

}  // namespace

int64_t WeightBytes(const Config& config, const Heads& heads) {
  ListedParameters list;
  LoadVggt(list, config, heads);
  int64_t numbers = 0;
  for (const auto& [name, shape] : list.shapes()) {
    int64_t size = 1;
    for (const int64_t n : shape) size *= n;
    numbers += size;
  }
  return kFloat * numbers;
}

int64_t PassBytes(const Config& config, const Pass& pass) {
  const int64_t patch = config.aggregator.backbone.patch;
  const int64_t patches = (pass.height / patch) * (pass.width / patch);
  const int64_t tokens = pass.views * (1 + config.aggregator.registers + patches);
  const int64_t row = kFloat * tokens * config.aggregator.width();
  const int64_t block = kWidthsInBlock * row;
  const int64_t kept = (pass.heads.depth ? 4 : pass.heads.camera ? 1 : 0) * kWidthsKept * row;
  const int64_t images = 3 * kFloat * 3 * pass.views * pass.height * pass.width;
  return kept + images + std::max(block, pass.heads.depth ? DenseBytes(config, pass) : 0) + kBytesOnTop;
}

}  // namespace oraclegs::vggt
