#include "oraclegs/networks/vggt/aggregator.h"

#include <algorithm>
#include <set>

#include "oraclegs/core/interrupt.h"
#include "oraclegs/networks/common/attention.h"
#include "oraclegs/networks/common/autocast.h"

namespace oraclegs::vggt {
namespace {

/// token [1, 2, n, width] -> [views, n, width]: the first set for view 0, the second for all others.
Tensor PerView(const Tensor& token, int64_t views) {
  return at::cat({token.select(1, 0), token.select(1, 1).expand({views - 1, -1, -1})}, 0);
}

struct Views {
  int64_t count = 0, special = 0, patches = 0;
  int64_t tokens() const { return special + patches; }
};

/// attention [N] over the tokens of all views -> [S, P], over their patches alone.
Tensor OnPatches(const Tensor& attention, const Views& views) {
  return attention.view({views.count, views.tokens()}).slice(1, views.special);
}

/// Summary of the attention of q, k [1, heads, N, width / heads].
GlobalAttention SummarizeAttention(const Tensor& q, const Tensor& k, const Views& views,
                                   const AttentionQueries& queries) {
  std::vector<Tensor> from_patches, from_camera;
  const int64_t asked = queries.views > 0 ? std::min(queries.views, views.count) : views.count;
  for (int64_t i = 0; i < asked; ++i) {
    const Tensor own = q[0].slice(1, i * views.tokens(), (i + 1) * views.tokens());
    if (queries.patches) from_patches.push_back(OnPatches(MeanAttention(own.slice(1, views.special), k[0]), views));
    if (queries.camera) from_camera.push_back(OnPatches(MeanAttention(own.slice(1, 0, 1), k[0]), views));
  }
  GlobalAttention attention;
  if (queries.patches) attention.from_patches = at::stack(from_patches);
  if (queries.camera) attention.from_camera = at::stack(from_camera);
  return attention;
}

/// Highest layer asked for. Throws ShapeError.
int64_t LastLayer(const AggregatorRequest& request, int64_t depth) {
  std::set<int64_t> all(request.token_layers.begin(), request.token_layers.end());
  all.insert(request.attention_layers.begin(), request.attention_layers.end());
  if (all.empty()) throw ShapeError("Aggregate: no layer is asked for");
  if (*all.begin() < 0 || *all.rbegin() >= depth) {
    throw ShapeError("Aggregate: layers {} are asked for, there are 0 to {}", fmt::join(all, ", "), depth - 1);
  }
  return *all.rbegin();
}

bool Contains(const std::vector<int64_t>& layers, int64_t layer) {
  return std::find(layers.begin(), layers.end(), layer) != layers.end();
}

}  // namespace

Aggregator LoadAggregator(const ParameterScope& at, const AggregatorConfig& config) {
  Aggregator aggregator;
  aggregator.config = config;
  aggregator.camera_token = at.Get("camera_token", {1, 2, 1, config.width()});
  aggregator.register_token = at.Get("register_token", {1, 2, config.registers, config.width()});
  aggregator.backbone = LoadVit(at / "patch_embed", config.backbone);
  const BlockConfig block{config.width(), config.heads, config.mlp_ratio, config.norm_eps, config.query_key_norm};
  for (int64_t i = 0; i < config.depth; ++i) {
    aggregator.frame_blocks.push_back(LoadBlock(at / "frame_blocks" / i, block));
    aggregator.global_blocks.push_back(LoadBlock(at / "global_blocks" / i, block));
  }
  return aggregator;
}

Tensor EmbedViews(const Aggregator& aggregator, const Tensor& images) {
  RequireImages("EmbedViews", images, aggregator.config.backbone.patch);
  const int64_t views = images.size(0);
  const Vit& backbone = aggregator.backbone;
  const Tensor tokens = LayerTokens(backbone, NormalizeRgb(images), {backbone.config.depth - 1})[0];
  return at::cat({PerView(aggregator.camera_token, views), PerView(aggregator.register_token, views),
                  tokens.slice(1, backbone.special_tokens())},
                 1);
}

AggregatorResult Aggregate(const Aggregator& aggregator, const Tensor& images, const AggregatorRequest& request) {
  const AggregatorConfig& config = aggregator.config;
  const int64_t last = LastLayer(request, config.depth);
  const Autocast scope(images.device(), aggregator.products);
  Tensor x = EmbedViews(aggregator, images);
  const int64_t patch = config.backbone.patch;
  const RopeGrid grid{aggregator.special_tokens(), images.size(2) / patch, images.size(3) / patch};
  const Views views{images.size(0), grid.special, grid.rows * grid.cols};
  RopeTable frame_rope = MakeRopeTable(grid, config.width() / config.heads, config.rope_base);
  frame_rope = {frame_rope.cos.to(x.options()), frame_rope.sin.to(x.options())};  // converted once, not in every block
  const RopeTable global_rope = Repeat(frame_rope, views.count);

  AggregatorResult result;
  for (int64_t l = 0; l <= last; ++l) {
    ThrowIfInterrupted();  // a pass over many views takes minutes on a CPU
    const Tensor framed = Forward(aggregator.frame_blocks[static_cast<size_t>(l)], x, &frame_rope);
    const Block& global = aggregator.global_blocks[static_cast<size_t>(l)];
    const Tensor all = framed.view({1, views.count * views.tokens(), config.width()});
    const bool keep = Contains(request.token_layers, l);
    Tensor attended;
    {
      const QueriesKeysValues in = AttentionInputs(global, all, &global_rope);
      if (Contains(request.attention_layers, l)) {
        result.attention[l] = SummarizeAttention(in.q, in.k, views, request.queries);
      }
      if (l == last && !keep) break;
      attended = Attend(in.q, in.k, in.v);
    }
    x = AfterAttention(global, all, attended).view({views.count, views.tokens(), config.width()});
    if (keep) result.tokens[l] = at::cat({framed, x}, 2);
  }
  return result;
}

}  // namespace oraclegs::vggt
