#include "oraclegs/networks/vggt/weights_file.h"

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <numeric>

namespace oraclegs::vggt {
namespace {

constexpr double kMaxSize = 1 << 16;
constexpr size_t kMaxNameLength = 60;
constexpr double kSumTolerance = 1e-6;

class Metadata {
 public:
  Metadata(const SafetensorsFile& file, std::string path) : entries_(file.metadata()), path_(std::move(path)) {}

  bool Has(const std::string& key) const { return entries_.count(key) > 0; }

  const std::string& Text(const std::string& key) const {
    const auto it = entries_.find(key);
    if (it == entries_.end()) throw InputError("{}: its metadata has no '{}'; get the file again", path_, key);
    return it->second;
  }

  /// Numbers of "4", "0.1" or "[1, 2]".
  std::vector<double> Numbers(const std::string& key) const {
    std::string text = Text(key);
    std::replace_if(
        text.begin(), text.end(), [](char c) { return c == '[' || c == ']' || c == ','; }, ' ');
    std::vector<double> numbers;
    const char* at = text.c_str();
    while (true) {
      char* end = nullptr;
      const double number = std::strtod(at, &end);
      if (end == at) break;
      numbers.push_back(number);
      at = end;
    }
    const bool rest = std::string(at).find_first_not_of(" \t") != std::string::npos;
    Require(!rest && !numbers.empty() &&
                std::all_of(numbers.begin(), numbers.end(), [](double n) { return std::isfinite(n); }),
            key, "are no numbers");
    return numbers;
  }

  double Number(const std::string& key) const {
    const std::vector<double> numbers = Numbers(key);
    Require(numbers.size() == 1, key, "is not one number");
    return numbers[0];
  }

  std::vector<int64_t> Counts(const std::string& key, double low) const {
    std::vector<int64_t> counts;
    for (const double n : Numbers(key)) {
      Require(n == std::floor(n) && n >= low && n <= kMaxSize, key, "is no size");
      counts.push_back(static_cast<int64_t>(n));
    }
    return counts;
  }

  int64_t Count(const std::string& key, double low = 1) const {
    const std::vector<int64_t> counts = Counts(key, low);
    Require(counts.size() == 1, key, "is not one number");
    return counts[0];
  }

  std::array<int64_t, 4> Four(const std::string& key, double low) const {
    const std::vector<int64_t> counts = Counts(key, low);
    Require(counts.size() == 4, key, "are not four numbers");
    return {counts[0], counts[1], counts[2], counts[3]};
  }

  void Require(bool ok, const std::string& key, const char* what) const {
    if (!ok) throw InputError("{}: '{}' of its metadata {}; get the file again", path_, key, what);
  }

 private:
  const std::map<std::string, std::string>& entries_;
  std::string path_;
};

Config NetworkOf(const Metadata& data) {
  Config config;
  AggregatorConfig& aggregator = config.aggregator;
  aggregator.depth = data.Count("depth");
  aggregator.heads = data.Count("num_heads");
  aggregator.mlp_ratio = data.Count("mlp_ratio");
  aggregator.registers = data.Count("num_register_tokens");
  aggregator.norm_eps = data.Number("aggregator_norm_eps");
  aggregator.rope_base = data.Number("rope_freq");
  aggregator.query_key_norm = data.Text("qk_norm") == "true" ? QueryKeyNorm::kLayerNorm : QueryKeyNorm::kNone;
  VitConfig& backbone = aggregator.backbone;
  backbone.width = data.Count("embed_dim");
  backbone.depth = data.Count("dino_depth");
  backbone.heads = data.Count("dino_num_heads");
  backbone.mlp_ratio = aggregator.mlp_ratio;
  backbone.patch = data.Count("patch_size");
  backbone.position_grid = data.Count("img_size") / backbone.patch;
  backbone.registers = aggregator.registers;
  backbone.norm_eps = data.Number("dino_norm_eps");
  backbone.position_offset = data.Number("pos_embed_offset");
  backbone.position_antialias = data.Text("pos_embed_antialias") == "true";
  config.camera.width = 2 * backbone.width;
  config.camera.depth = data.Count("camera_trunk_depth");
  config.camera.heads = data.Count("camera_num_heads");
  config.camera.mlp_ratio = aggregator.mlp_ratio;
  config.camera.iterations = data.Count("camera_num_iterations");
  config.dense_layers = data.Four("dpt_layers", 0);
  config.dense.width = 2 * backbone.width;
  config.dense.features = data.Count("dpt_features");
  config.dense.channels = data.Four("dpt_out_channels", 1);
  config.dense.patch = backbone.patch;
  return config;
}

/// Refuses files whose sizes the network's functions would report as errors of the program.
void RequireConsistent(const WeightsFile& file, const Metadata& data) {
  const AggregatorConfig& aggregator = file.network.aggregator;
  const int64_t width = aggregator.width();
  data.Require(width % (4 * aggregator.heads) == 0, "num_heads", "does not divide the width into multiples of 4");
  data.Require(width % aggregator.backbone.heads == 0, "dino_num_heads", "does not divide the width");
  data.Require(2 * width % file.network.camera.heads == 0, "camera_num_heads", "does not divide the width");
  data.Require(aggregator.backbone.position_grid > 0, "img_size", "is smaller than a patch");
  data.Require(file.network.dense.features % 8 == 0, "dpt_features", "is no multiple of 8");
  const auto exists = [&](int64_t layer) { return layer < aggregator.depth; };
  const auto& dense = file.network.dense_layers;
  const auto& channels = file.network.dense.channels;
  data.Require(std::all_of(dense.begin(), dense.end(), exists), "dpt_layers", "names a layer that is not there");
  data.Require(std::all_of(channels.begin(), channels.end(), [](int64_t c) { return c % 4 == 0; }), "dpt_out_channels",
               "are no multiples of 4");
  data.Require(std::all_of(file.oracle_layers.begin(), file.oracle_layers.end(), exists), "oracle_layers",
               "names a layer that is not there");
  const std::vector<double>& weights = file.oracle_weights;
  const double sum = std::accumulate(weights.begin(), weights.end(), 0.0);
  data.Require(weights.size() == file.oracle_layers.size() && std::abs(sum - 1) < kSumTolerance &&
                   std::all_of(weights.begin(), weights.end(), [](double w) { return w >= 0; }),
               "oracle_weights", "are not one share for each of the layers");
}

}  // namespace

WeightsFile ReadWeightsFile(const std::filesystem::path& path) {
  const SafetensorsFile stored = SafetensorsFile::Open(path);
  const Metadata data(stored, path.string());
  WeightsFile file;
  if (data.Has("model")) {
    file.name = data.Text("model").substr(0, kMaxNameLength);
    std::replace_if(
        file.name.begin(), file.name.end(), [](char c) { return c < ' ' || c > '~'; }, '?');
  }
  if (!data.Has("embed_dim")) return file;
  file.network = NetworkOf(data);
  file.side = data.Count("img_size");
  file.oracle_layers = data.Counts("oracle_layers", 0);
  file.oracle_weights = data.Numbers("oracle_weights");
  RequireConsistent(file, data);
  return file;
}

}  // namespace oraclegs::vggt
