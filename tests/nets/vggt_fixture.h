#pragma once
// The small VGGT of tests/golden: its sizes out of the metadata.

#include "nets/fixtures.h"
#include "oraclegs/nets/vggt.h"

namespace oraclegs {

inline constexpr const char* kVggtFixture = "vggt_tiny";

inline VggtConfig GoldenVggtConfig(const SafetensorsFile& file) {
  VggtConfig config;
  AggregatorConfig& aggregator = config.aggregator;
  aggregator.depth = Count(file, "depth");
  aggregator.heads = Count(file, "num_heads");
  aggregator.mlp_ratio = Count(file, "mlp_ratio");
  aggregator.registers = Count(file, "num_register_tokens");
  aggregator.norm_eps = Number(file, "aggregator_norm_eps");
  aggregator.rope_base = Number(file, "rope_freq");
  aggregator.query_key_norm = file.metadata().at("qk_norm") == "true" ? QueryKeyNorm::kLayerNorm : QueryKeyNorm::kNone;
  VitConfig& backbone = aggregator.backbone;
  backbone.width = Count(file, "embed_dim");
  backbone.depth = Count(file, "dino_depth");
  backbone.heads = Count(file, "dino_num_heads");
  backbone.mlp_ratio = aggregator.mlp_ratio;
  backbone.patch = Count(file, "patch_size");
  backbone.position_grid = Count(file, "img_size") / backbone.patch;
  backbone.registers = aggregator.registers;
  backbone.norm_eps = Number(file, "dino_norm_eps");
  backbone.position_offset = Number(file, "pos_embed_offset");
  backbone.position_antialias = file.metadata().at("pos_embed_antialias") == "true";
  config.camera.width = 2 * backbone.width;
  config.camera.depth = Count(file, "camera_trunk_depth");
  config.camera.heads = Count(file, "camera_num_heads");
  config.camera.mlp_ratio = aggregator.mlp_ratio;
  config.camera.iterations = Count(file, "camera_num_iterations");
  config.dense_layers = Counts<4>(file, "dpt_layers");
  config.dense.width = 2 * backbone.width;
  config.dense.features = Count(file, "dpt_features");
  config.dense.channels = Counts<4>(file, "dpt_out_channels");
  config.dense.patch = backbone.patch;
  return config;
}

inline Vggt GoldenVggt(const SafetensorsFile& file) {
  FileParameters source = GoldenWeights(kVggtFixture);
  Vggt vggt = LoadVggt(source, GoldenVggtConfig(file), {true, true, true});
  source.Finish();
  return vggt;
}

inline PatchGrid GoldenGrid(const SafetensorsFile& file) {
  const int64_t patch = Count(file, "patch_size");
  return {Count(file, "height") / patch, Count(file, "width") / patch};
}

inline std::vector<int64_t> OracleLayers(const SafetensorsFile& file) {
  std::vector<int64_t> layers;
  for (const double layer : Numbers(file, "oracle_layers")) layers.push_back(static_cast<int64_t>(layer));
  return layers;
}

}  // namespace oraclegs
