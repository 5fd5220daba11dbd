#include "oraclegs/gaussians/damaged_rows.h"

#include <algorithm>
#include <cmath>

#include "oraclegs/core/error.h"
#include "oraclegs/core/parallel.h"
#include "oraclegs/gaussians/selection.h"

namespace oraclegs {
namespace {

constexpr int64_t kRepairGrain = 4096;  // Gaussians a task
constexpr int64_t kToleratedOf = 10;    // one in so many may be damaged
constexpr float kLogitOfOne = 15;       // of the last opacities that float32 distinguishes from 0 and 1
constexpr float kLogOfFlat = -69.07755f;

enum class RowState : char { kFine, kDamaged, kWithoutRotation };

/// A quaternion of length 1, which every finite one but zero has.
RowState RepairRotation(float* q) {
  const float squared = q[0] * q[0] + q[1] * q[1] + q[2] * q[2] + q[3] * q[3];  // by which a renderer divides
  if (std::isnormal(squared)) return RowState::kFine;
  const double length = std::hypot(std::hypot(double{q[0]}, double{q[1]}), std::hypot(double{q[2]}, double{q[3]}));
  for (int c = 0; c < 4; ++c) q[c] = length > 0 ? static_cast<float>(q[c] / length) : static_cast<float>(c == 0);
  return length > 0 ? RowState::kFine : RowState::kWithoutRotation;
}

bool AllFinite(const float* values, int count) {
  return std::all_of(values, values + count, [](float x) { return std::isfinite(x); });
}

RowState Repair(const GaussianRows& g) {
  // An opacity of exactly 0 or 1 is usual after a conversion from 8-bit alpha; training could not change its logit.
  if (std::isinf(*g.opacity_logits)) *g.opacity_logits = std::copysign(kLogitOfOne, *g.opacity_logits);
  for (int c = 0; c < 3; ++c) {
    if (g.log_scales[c] == -INFINITY) g.log_scales[c] = kLogOfFlat;
  }
  const bool finite = AllFinite(g.means, 3) && AllFinite(g.log_scales, 3) && AllFinite(g.quats, 4) &&
                      std::isfinite(*g.opacity_logits) && AllFinite(g.sh, kShFloats);
  return finite ? RepairRotation(g.quats) : RowState::kDamaged;
}

/// "x of Gaussian 3 is nan", by the names of a PLY.
std::string DescribeDamage(const Gaussians& gaussians, int64_t i) {
  const GaussianRows g = gaussians.Rows().From(i);
  std::string text;
  const auto look = [&](const char* stem, const float* values, int count) {
    for (int c = 0; c < count && text.empty(); ++c) {
      if (!std::isfinite(values[c])) text = fmt::format("{}{} of Gaussian {} is {}", stem, c, i, values[c]);
    }
  };
  for (int c = 0; c < 3 && text.empty(); ++c) {
    if (!std::isfinite(g.means[c])) text = fmt::format("{} of Gaussian {} is {}", "xyz"[c], i, g.means[c]);
  }
  look("scale_", g.log_scales, 3);
  look("rot_", g.quats, 4);
  if (text.empty() && !std::isfinite(*g.opacity_logits)) {
    text = fmt::format("opacity of Gaussian {} is {}", i, *g.opacity_logits);
  }
  look("f_dc_", g.sh, 3);
  look("f_rest_", g.sh + 3, kShFloats - 3);
  return text;
}

}  // namespace

void LeaveOutDamaged(const std::string& file, Gaussians* gaussians, GaussianMarks* marks,
                     std::vector<std::string>* warnings) {
  const int64_t n = gaussians->size();
  std::vector<RowState> states(static_cast<size_t>(n));
  const GaussianRows all = gaussians->Rows();
  ParallelBlocks(n, kRepairGrain, [&](int64_t begin, int64_t end) {
    for (int64_t i = begin; i < end; ++i) states[i] = Repair(all.From(i));
  });
  const int64_t damaged = std::count(states.begin(), states.end(), RowState::kDamaged);
  const int64_t unturned = std::count(states.begin(), states.end(), RowState::kWithoutRotation);
  if (damaged > 0) {
    const int64_t first = std::find(states.begin(), states.end(), RowState::kDamaged) - states.begin();
    const std::string what = DescribeDamage(*gaussians, first);
    if (damaged * kToleratedOf > n) {
      throw InputError(
          "{}: {} of {} Gaussians have numbers that are not finite: {}; the training that wrote it diverged or the "
          "file "
          "is damaged, export it again",
          file, damaged, n, what);
    }
    std::vector<int64_t> kept;
    for (int64_t i = 0; i < n; ++i) {
      if (states[i] != RowState::kDamaged) kept.push_back(i);
    }
    *gaussians = Picked(*gaussians, kept);
    *marks = Picked(*marks, kept);
    warnings->push_back(fmt::format("{}: {} of {} Gaussians have numbers that are not finite and are left out: {}",
                                    file, damaged, n, what));
  }
  if (unturned > 0) {
    warnings->push_back(
        fmt::format("{}: {} of {} Gaussians have a rotation of zeros, which is none; they are taken as not turned",
                    file, unturned, n));
  }
}

}  // namespace oraclegs
