#pragma once
// The small UNet of tests/golden, its inputs, and how well a result must agree.

#include <cmath>
#include <nlohmann/json.hpp>

#include "networks/fixtures.h"
#include "oraclegs/networks/seva/unet.h"

namespace oraclegs::seva {

inline constexpr const char* kUnetFixture = "seva_unet_tiny";
inline constexpr double kUnetTolerance = 5e-5;  // max |a - b| / max |b|

inline std::vector<int64_t> Integers(const SafetensorsFile& file, const std::string& key) {
  std::vector<int64_t> out;
  for (const double number : Numbers(file, key)) out.push_back(static_cast<int64_t>(number));
  return out;
}

/// The texts of a list such as ["a", "b"].
inline std::vector<std::string> Words(const SafetensorsFile& file, const std::string& key) {
  std::vector<std::string> out;
  for (const auto& word : nlohmann::json::parse(file.metadata().at(key))) out.push_back(word.get<std::string>());
  return out;
}

inline UnetConfig GoldenUnetConfig(const SafetensorsFile& file) {
  UnetConfig config;
  config.channels = Count(file, "model_channels");
  config.res_blocks = Count(file, "num_res_blocks");
  config.attention_downscales = Integers(file, "attention_resolutions");
  config.channel_mult = Integers(file, "channel_mult");
  config.head_width = Count(file, "num_head_channels");
  config.transformer_depth = Integers(file, "transformer_depth");
  config.context_width = Count(file, "context_dim");
  config.joint = Words(file, "unflatten_names");
  return config;
}

struct GoldenUnet {
  SafetensorsFile file = OpenGolden(kUnetFixture);
  Unet unet;
  Tensor x, steps;  ///< latent with mask and rays; step indices
  Conditions conditions;

  GoldenUnet() {
    FileParameters source = GoldenWeights(kUnetFixture);
    unet = LoadUnet(source, GoldenUnetConfig(file));
    source.Finish();
    x = at::cat({GoldenFloat(file, "input.x"), GoldenFloat(file, "input.concat")}, 1);
    steps = GoldenTensor(file, "input.t").to(torch::kLong);
    conditions = {GoldenFloat(file, "input.crossattn"), GoldenFloat(file, "input.dense_vector"),
                  file.Values<int64_t>("input.num_frames").at(0), x.size(2), x.size(3)};
  }
  Tensor Embedding() const { return at::silu(TimeEmbedding(unet, steps)); }
};

/// max |a - b| / max |b| of a stored tensor.
inline void ExpectGoldenRatio(const Tensor& actual, const SafetensorsFile& file, const std::string& name,
                              double tolerance = kUnetTolerance) {
  ExpectGolden(actual, file, name, tolerance * GoldenTensor(file, name).abs().max().item<double>());
}

}  // namespace oraclegs::seva
