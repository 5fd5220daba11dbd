#pragma once
// Folders of weights of networks so small that a whole run takes seconds.

#include "networks/network_files.h"
#include "networks/seva/tiny_files.h"
#include "support/network_files.h"

namespace oraclegs {

/// All networks of the paper's pipeline, as `oraclegs models` stores them.
inline void MakeTinyNetworks(const std::filesystem::path& models) {
  seva::MakeTinySeva(models);
  WriteTinyVggt(models / "vggt" / "model.safetensors");
  MakeTinyDepthAnything(models / "depth-anything-v2-small" / "model.safetensors");
  MakeTinyLpips(models / "lpips-vgg" / "model.safetensors");
}

/// Source files for support/network_files.h: the networks with several weights.
inline void MakeTinyVariants(const std::filesystem::path& folder) {
  for (const uint64_t seed : {5, 6}) {
    MakeTinyDepthAnything(folder / fmt::format("depth_anything_{}.safetensors", seed), seed);
  }
  for (const uint64_t seed : {7, 8}) MakeTinyLpips(folder / fmt::format("lpips_{}.safetensors", seed), seed);
  MakeTinyLpips(folder / "lpips_alex.safetensors", 7, FeatureNetwork::kAlexNet);
  MakeTinyAliked(folder / "aliked.safetensors");
}

}  // namespace oraclegs
