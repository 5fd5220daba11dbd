#pragma once
// VGGT's aggregator: blocks that attend inside each view and over all views in turn (docs/method.md#vggt-aggregator).

#include <map>
#include <optional>
#include <vector>

#include "oraclegs/networks/common/vit.h"

namespace oraclegs::vggt {

struct AggregatorConfig {
  VitConfig backbone{
      .width = 1024, .depth = 24, .heads = 16, .registers = 4, .position_offset = 0, .position_antialias = true};
  int64_t depth = 24;  ///< pairs of a frame block and a global block
  int64_t heads = 16;
  int64_t mlp_ratio = 4;
  int64_t registers = 4;
  double norm_eps = 1e-5;
  double rope_base = 100;
  QueryKeyNorm query_key_norm = QueryKeyNorm::kLayerNorm;

  int64_t width() const { return backbone.width; }
};

struct Aggregator {
  AggregatorConfig config;
  Vit backbone;
  Tensor camera_token, register_token;  ///< [1, 2, 1 or registers, width]; along axis 1: for view 0, for the others
  std::vector<Block> frame_blocks, global_blocks;
  std::optional<torch::ScalarType> products;  ///< type of its matrix products; unset = the weights' (Autocast)

  /// Tokens before a view's patches: the camera's and the registers.
  int64_t special_tokens() const { return 1 + config.registers; }
};
Aggregator LoadAggregator(const ParameterScope& at, const AggregatorConfig& config);

/// Queries whose attention is computed. Each costs a row over all tokens of the pass.
struct AttentionQueries {
  int64_t views = 0;  ///< the first views, Q of them; 0 = all
  bool patches = true;
  bool camera = true;
};

/// Attention of one global block to the patches, mean over heads. [i, j, p]: from view i to patch p of view j.
struct GlobalAttention {
  Tensor from_patches;  ///< [Q, S, P] float32: mean over the patches of view i as queries; undefined without
  Tensor from_camera;   ///< [Q, S, P] float32: the camera token of view i as the only query; undefined without
};

/// Results wanted from a pass over the views.
struct AggregatorRequest {
  std::vector<int64_t> token_layers;      ///< layers whose tokens the heads read
  std::vector<int64_t> attention_layers;  ///< layers whose global attention an oracle reads
  AttentionQueries queries = {};
};

struct AggregatorResult {
  std::map<int64_t, Tensor> tokens;  ///< [S, special + P, 2 width]: output of the frame block, then of the global block
  std::map<int64_t, GlobalAttention> attention;
};

/// Tokens that enter the first frame block: [S, special + P, width]. images [S, 3, H, W] float32 RGB in [0, 1], sides
/// multiples of the patch; view 0 is the reference. Throws ShapeError.
Tensor EmbedViews(const Aggregator& aggregator, const Tensor& images);

/// Runs the layers up to the last one asked for; nothing is computed after the last attention. Throws ShapeError for
/// layers that do not exist and for a request without layers, Interrupted between two layers.
AggregatorResult Aggregate(const Aggregator& aggregator, const Tensor& images, const AggregatorRequest& request);

}  // namespace oraclegs::vggt
