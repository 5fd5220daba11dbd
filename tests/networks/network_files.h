#pragma once
// Makes files of small networks with made-up weights.

#include <filesystem>
#include <map>
#include <nlohmann/json.hpp>
#include <string>

#include "oraclegs/core/files.h"
#include "oraclegs/networks/aliked/aliked.h"
#include "oraclegs/networks/depth_anything/depth_anything.h"
#include "oraclegs/networks/lpips/lpips.h"

namespace oraclegs {

/// Parameter source that makes weights up and keeps them by name.
class KeptParameters : public ParameterSource {
 public:
  explicit KeptParameters(uint64_t seed) : random_(seed) {}
  Tensor Get(const std::string& name, at::IntArrayRef shape) override {
    return tensors_[name] = random_.Get(name, shape);
  }
  void Unused(const std::string&, at::IntArrayRef) override {}
  Tensor& at(const std::string& name) { return tensors_.at(name); }

  /// `sizes` become its metadata.
  std::filesystem::path Write(const std::filesystem::path& path,
                              const std::map<std::string, nlohmann::json>& sizes = {}) const {
    std::map<std::string, TensorEntry> entries;
    for (const auto& [name, t] : tensors_) {
      const std::string_view bytes(static_cast<const char*>(t.data_ptr()), static_cast<size_t>(t.numel()) * 4);
      entries[name] = {"F32", t.sizes().vec(), bytes};
    }
    std::map<std::string, std::string> metadata;
    for (const auto& [name, value] : sizes) metadata[name] = value.dump();
    WriteFileAtomically(path, SerializeSafetensors(entries, metadata));
    return path;
  }

 private:
  RandomParameters random_;
  std::map<std::string, Tensor> tensors_;
};

/// Depth Anything V2 of four narrow blocks; its input is 70 pixels.
inline DepthAnythingConfig TinyDepthAnything() {
  DepthAnythingConfig config;
  config.backbone.width = config.head.width = 64;
  config.backbone.heads = 1, config.backbone.depth = 4, config.backbone.position_grid = 5;
  config.layers = {0, 1, 2, 3};
  config.head.features = 16;
  config.head.channels = {8, 16, 24, 32};
  config.input_side = 70;
  return config;
}

inline std::filesystem::path MakeTinyDepthAnything(const std::filesystem::path& path, uint64_t seed = 5) {
  KeptParameters parameters(seed);
  LoadDepthAnything(parameters, TinyDepthAnything());
  parameters.at("depth_head.scratch.output_conv2.2.bias").fill_(3);  // else half of all seeds give a map of zeros
  return parameters.Write(path);
}

inline std::filesystem::path MakeTinyLpips(const std::filesystem::path& path, uint64_t seed = 7,
                                           FeatureNetwork network = FeatureNetwork::kVgg16) {
  KeptParameters parameters(seed);
  LoadLpips(parameters, {network, {4, 6, 8, 10, 12}});
  for (int i = 0; i < 5; ++i) parameters.at("lin" + std::to_string(i) + ".model.1.weight").abs_();  // none is negative
  return parameters.Write(path);
}

/// ALIKED of narrow blocks and four samples; noise has many keypoints by it.
inline std::filesystem::path MakeTinyAliked(const std::filesystem::path& path, uint64_t seed = 9) {
  KeptParameters parameters(seed);
  aliked::LoadAliked(parameters, {{4, 8, 12, 16}, 4});
  for (int block = 1; block <= 4; ++block) {
    for (int norm = 1; norm <= 2; ++norm) parameters.at(fmt::format("block{}.bn{}.running_var", block, norm)).fill_(1);
  }
  parameters.at("score_head.6.weight").mul_(4);  // scores that differ
  return parameters.Write(path);
}

}  // namespace oraclegs
