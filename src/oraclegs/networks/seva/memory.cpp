#include "oraclegs/networks/seva/memory.h"

#include <algorithm>
#include <vector>

#include "oraclegs/core/text.h"
#include "oraclegs/networks/seva/slices.h"

namespace oraclegs::seva {
namespace {

constexpr int64_t kFloat = 4;
constexpr int64_t kColors = 3;
constexpr int64_t kTileStep = 16, kMinTile = 32;                     // latent pixels
constexpr int64_t kSuggestedFrames = 21, kSuggestedShortSide = 384;  // what the error suggests

/// Bytes a pixel that a residual block holds at its largest, in the weights' type and in float32.
int64_t ResBytes(int64_t in, int64_t out, int64_t type) { return in * (kFloat + 2 * type) + out * (kFloat + 3 * type); }
/// Bytes a pixel of a multi-view transformer: its input, tokens, norms, queries, keys, values and their regrouped
/// copies.
int64_t MultiViewBytes(int64_t channels, int64_t type) { return channels * (kFloat + 11 * type); }

/// Largest activations along the UNet, for one frame's latents.
struct Walk {
  const UnetConfig& config;
  int64_t type, pixels;
  int64_t skips = 0, largest = 0;

  int64_t PixelsAt(size_t level) const { return pixels >> (2 * level); }
  int64_t ChannelsAt(size_t level) const { return config.channels * config.channel_mult[level]; }

  void Block(int64_t in, int64_t out, size_t level) {
    const int64_t bytes = std::max(ResBytes(in, out, type), MultiViewBytes(out, type));
    largest = std::max(largest, bytes * PixelsAt(level));
  }

  void Run() {
    std::vector<int64_t> channels = {config.channels};
    const size_t levels = config.channel_mult.size();
    skips += config.channels * pixels * type;
    int64_t now = config.channels;
    const auto push = [&](int64_t width, size_t level) {
      channels.push_back(width);
      skips += width * PixelsAt(level) * type;
    };
    for (size_t level = 0; level < levels; ++level) {
      for (int64_t i = 0; i < config.res_blocks; ++i) {
        Block(now, ChannelsAt(level), level);
        now = ChannelsAt(level);
        push(now, level);
      }
      if (level + 1 < levels) push(now, level + 1);
    }
    for (size_t level = levels; level-- > 0;) {
      for (int64_t i = 0; i <= config.res_blocks; ++i) {
        Block(now + channels.back(), ChannelsAt(level), level);
        channels.pop_back();
        now = ChannelsAt(level);
      }
    }
  }
};

int64_t BytesOf(torch::ScalarType type) { return static_cast<int64_t>(c10::elementSize(type)); }

int64_t WeightBytes(const UnetConfig& config, torch::ScalarType type) {
  ListedParameters listed;
  LoadUnet(listed, config);
  int64_t numbers = 0;
  for (const auto& [name, shape] : listed.shapes()) numbers += c10::multiply_integers(shape);
  return numbers * BytesOf(type);
}

/// "--seva-frames 21 (12.3 GB)", ...: the options that lower the need, cheapest in quality first.
std::string Suggestions(const UnetConfig& config, const MemoryRequest& request) {
  std::vector<std::string> options;
  const auto suggest = [&](const std::string& option, const MemoryRequest& other) {
    options.push_back(fmt::format("{} ({:.1f} GB)", option, Gigabytes(EstimateMemory(config, other).total())));
  };
  if (request.halves == Halves::kBatched) {
    MemoryRequest other = request;
    other.halves = Halves::kInTurn;
    suggest("--set seva-halves=in-turn", other);
  }
  if (request.type == torch::kFloat) {
    MemoryRequest other = request;
    other.type = torch::kBFloat16;
    other.other_weights /= 2;
    suggest("--set seva-precision=bfloat16", other);
  }
  if (request.frames > kSuggestedFrames) {
    MemoryRequest other = request;
    other.frames = kSuggestedFrames;
    suggest(fmt::format("--seva-frames {}", kSuggestedFrames), other);
  }
  if (std::min(request.size.width, request.size.height) > kSuggestedShortSide) {
    MemoryRequest other = request;
    other.size = WorkingSize(request.size, kSuggestedShortSide);
    suggest(fmt::format("--seva-short-side {}", kSuggestedShortSide), other);
  }
  if (options.empty()) return "more memory is needed";
  return fmt::format("less is needed with {}", fmt::join(options, ", or "));
}

}  // namespace

Memory EstimateMemory(const UnetConfig& config, const MemoryRequest& request) {
  const int64_t rows = request.frames * (request.halves == Halves::kBatched ? 2 : 1);
  const int64_t pixels = (request.size.width / kLatentStride) * (request.size.height / kLatentStride);
  Walk walk{config, BytesOf(request.type), pixels};
  walk.Run();
  Memory memory;
  memory.weights = WeightBytes(config, request.type) + request.other_weights;
  memory.skips = rows * walk.skips;
  memory.activations = rows * walk.largest;
  memory.attention = 3 * kFloat * (request.gpu ? kSliceOnGpu : kSliceOnCpu);  // a slice, its gate, scores
  return memory;
}

Halves ChooseHalves(const UnetConfig& config, MemoryRequest request, const SevaOptions& options, int64_t available) {
  for (const Halves halves : {Halves::kBatched, Halves::kInTurn}) {
    if (!options.halves.is_auto() && options.halves.value() != halves) continue;
    request.halves = halves;
    if (EstimateMemory(config, request).total() <= available) return halves;
  }
  const Memory need = EstimateMemory(config, request);
  throw RunError(
      "seva needs about {:.1f} GB for {} frames of {} x {} (weights {:.1f}, skips {:.1f}, activations {:.1f}, "
      "attention {:.1f}) and {:.1f} GB are there; {}",
      Gigabytes(need.total()), request.frames, request.size.width, request.size.height, Gigabytes(need.weights),
      Gigabytes(need.skips), Gigabytes(need.activations), Gigabytes(need.attention), Gigabytes(available),
      Suggestions(config, request));
}

AutoencoderMemory EstimateAutoencoder(const VaeConfig& config, torch::ScalarType type) {
  const int64_t bytes = BytesOf(type), levels = static_cast<int64_t>(config.channels.size());
  AutoencoderMemory memory;
  for (int64_t level = 0; level < levels; ++level) {
    const auto channels = [&](int64_t l) {
      return config.channels[static_cast<size_t>(std::clamp<int64_t>(l, 0, levels - 1))];
    };
    const int64_t pixels = int64_t{1} << (2 * (levels - 1 - level));  // pixels of this level a latent pixel
    memory.encode = std::max(memory.encode, pixels * ResBytes(channels(level - 1), channels(level), bytes));
    memory.tile = std::max(memory.tile, pixels * ResBytes(channels(level + 1), channels(level), bytes));
    // The level's last image at twice the size, and its convolution.
    if (level > 0) memory.tile = std::max(memory.tile, pixels * 9 * channels(level) * bytes);
  }
  const int64_t width = config.channels.back(), pixels = config.downscale() * config.downscale();
  const int64_t image = 2 * kColors * pixels * kFloat;
  memory.encode += image;
  memory.frame = image + std::max(ResBytes(width, width, bytes), width * (kFloat + 7 * bytes));
  return memory;
}

int64_t ChooseTile(const TileRequest& request, int64_t available) {
  const int64_t height = request.size.height / kLatentStride, width = request.size.width / kLatentStride;
  const AutoencoderMemory& takes = request.takes;
  const int64_t fixed = request.weights + takes.weights, longer = std::max(height, width);
  const auto decoding = [&](int64_t side) {
    return fixed + takes.frame * height * width + takes.tile * std::min(side, height) * std::min(side, width);
  };
  const int64_t encoding = fixed + takes.encode * height * width;
  int64_t side = longer;
  if (decoding(side) > available) side = (longer - 1) / kTileStep * kTileStep;
  while (side > kMinTile && decoding(side) > available) side -= kTileStep;
  if (side == longer && encoding <= available) return side;
  side = std::max(side, std::min(longer, kMinTile));
  const int64_t need = std::max(encoding, decoding(side));
  if (need <= available) return side;
  throw RunError(
      "seva needs about {:.1f} GB to bring images of {} x {} to latents and back and {:.1f} GB are there; less is "
      "needed with a smaller --seva-short-side",
      Gigabytes(need), request.size.width, request.size.height, Gigabytes(available));
}

}  // namespace oraclegs::seva
