#include "oraclegs/networks/common/attention.h"

#include <torch/version.h>

#include <algorithm>
#include <cmath>

#include "oraclegs/networks/common/autocast.h"

namespace oraclegs {
namespace {

// 16 MiB: the allocator gives the same pages again and again, and a tile's second pass finds it in the cache.
constexpr int64_t kScoresOnCpu = int64_t{1} << 22;
constexpr int64_t kScoresOnGpu = int64_t{1} << 28;

int64_t Budget(const Tensor& t, int64_t max_scores) {
  if (max_scores > 0) return max_scores;
  return t.is_cuda() ? kScoresOnGpu : kScoresOnCpu;
}

/// q [G, Q, width] as it enters the product with the keys.
Tensor Scaled(const Tensor& q) { return q * (1.0 / std::sqrt(static_cast<double>(q.size(-1)))); }

void RequireFit(const char* who, bool fits, const Tensor& q, const Tensor& k) {
  if (fits) return;
  throw ShapeError("{}: queries [{}] and keys [{}] do not fit", who, fmt::join(q.sizes(), ", "),
                   fmt::join(k.sizes(), ", "));
}

}  // namespace

Tensor Attend(const Tensor& q, const Tensor& k, const Tensor& v, int64_t max_scores) {
  RequireFit("Attend",
             q.dim() == 4 && k.dim() == 4 && k.sizes() == v.sizes() && q.size(0) == k.size(0) &&
                 q.size(1) == k.size(1) && q.size(3) == k.size(3),
             q, k);
#if TORCH_VERSION_MAJOR >= 2
  if (q.is_cuda()) return at::scaled_dot_product_attention(q, k, v);
#endif
  const int64_t groups = q.size(0) * q.size(1), queries = q.size(2), keys = k.size(2), width = q.size(3);
  const Tensor flat_q = Scaled(q).reshape({groups, queries, width});
  const Tensor flat_k = k.reshape({groups, keys, width}).transpose(1, 2), flat_v = v.reshape({groups, keys, width});
  const Tensor out = at::empty({groups, queries, width}, q.options());
  const int64_t budget = Budget(q, max_scores);
  const int64_t rows = std::clamp<int64_t>(budget / std::max<int64_t>(keys, 1), 1, std::max<int64_t>(queries, 1));
  const int64_t together = rows < queries ? 1 : std::max<int64_t>(budget / (rows * std::max<int64_t>(keys, 1)), 1);
  for (int64_t g = 0; g < groups; g += together) {
    const int64_t g_end = std::min(g + together, groups);
    for (int64_t r = 0; r < queries; r += rows) {
      const int64_t r_end = std::min(r + rows, queries);
      const Tensor scores = at::bmm(flat_q.slice(0, g, g_end).slice(1, r, r_end), flat_k.slice(0, g, g_end));
      const Tensor weights = at::softmax(scores, -1, torch::kFloat).to(v.scalar_type());
      out.slice(0, g, g_end).slice(1, r, r_end).copy_(at::bmm(weights, flat_v.slice(0, g, g_end)));
    }
  }
  return out.view(q.sizes());
}

Tensor MeanAttention(const Tensor& q, const Tensor& k, int64_t max_scores) {
  RequireFit("MeanAttention", q.dim() == 3 && k.dim() == 3 && q.size(0) == k.size(0) && q.size(2) == k.size(2), q, k);
  const Autocast exact(q.device(), std::nullopt);  // the oracle's maps are read from these scores
  const int64_t heads = q.size(0), queries = q.size(1), keys = k.size(1);
  if (heads == 0 || queries == 0) throw ShapeError("MeanAttention: there are no queries to take the mean of");
  const Tensor sum = at::zeros({keys}, q.options().dtype(torch::kDouble));
  const int64_t rows = std::clamp<int64_t>(Budget(q, max_scores) / std::max<int64_t>(keys, 1), 1, queries);
  for (int64_t h = 0; h < heads; ++h) {
    const Tensor head_q = Scaled(q.select(0, h).to(torch::kFloat));
    const Tensor head_k = k.select(0, h).to(torch::kFloat).t();
    for (int64_t r = 0; r < queries; r += rows) {
      const Tensor scores = at::mm(head_q.slice(0, r, std::min(r + rows, queries)), head_k);
      sum.add_(at::softmax(scores, -1).sum(0));
    }
  }
  return sum.div_(static_cast<double>(heads * queries)).to(torch::kFloat);
}

}  // namespace oraclegs
