#pragma once
// The small autoencoder of tests/golden: its sizes out of the metadata.

#include "networks/fixtures.h"
#include "oraclegs/networks/seva/vae.h"

namespace oraclegs::seva {

inline constexpr const char* kVaeFixture = "seva_vae_tiny";
inline constexpr double kVaeTolerance = 5e-5;  // max |a - b| / max |b|

inline VaeConfig GoldenVaeConfig(const SafetensorsFile& file) {
  VaeConfig config;
  config.channels.clear();
  for (const double channels : Numbers(file, "block_out_channels")) {
    config.channels.push_back(static_cast<int64_t>(channels));
  }
  config.resnets = Count(file, "layers_per_block");
  config.latent_channels = Count(file, "latent_channels");
  config.norm.groups = Count(file, "norm_num_groups");
  return config;
}

inline Vae GoldenVae(const SafetensorsFile& file) {
  FileParameters source = GoldenWeights(kVaeFixture);
  Vae vae = LoadVae(source, GoldenVaeConfig(file));
  source.Finish();
  return vae;
}

inline void ExpectGoldenVae(const Tensor& actual, const SafetensorsFile& file, const std::string& name) {
  ExpectGolden(actual, file, name, kVaeTolerance * GoldenTensor(file, name).abs().max().item<double>());
}

}  // namespace oraclegs::seva
