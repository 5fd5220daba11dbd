#include "oraclegs/train/refine_schedule.h"

namespace oraclegs {
namespace {

bool IsBeforeTheEnd(const TrainOptions& options, int64_t i) {
  return i < options.iterations.value() &&
         static_cast<double>(i) < options.refine_stop * static_cast<double>(options.Horizon());
}

}  // namespace

bool Refines(const TrainOptions& options, int64_t i) {
  return IsBeforeTheEnd(options, i) && i > options.refine_start.value() && i % options.refine_every.value() == 0;
}

bool ResetsOpacities(const TrainOptions& options, bool is_background_white, int64_t i) {
  const BaselineOptions& baseline = options.baseline;
  const int64_t every = baseline.opacity_reset, first = baseline.opacity_reset_first.ValueOr(baseline.opacity_reset);
  if (baseline.densify != Densify::kAdaptive || every == 0 || !IsBeforeTheEnd(options, i)) return false;
  const bool is_start =
      is_background_white && baseline.opacity_reset_first.is_auto() && i == options.refine_start.value();
  return is_start || (i >= first && (i - first) % every == 0);
}

}  // namespace oraclegs
