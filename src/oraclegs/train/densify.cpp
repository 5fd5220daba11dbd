#include "oraclegs/train/densify.h"

namespace oraclegs {

bool IsBeforeRefineStop(const TrainOptions& options, int64_t i) {
  return i < options.iterations &&
         static_cast<double>(i) < options.refine_stop * static_cast<double>(options.Horizon());
}

bool Refines(const TrainOptions& options, int64_t i) {
  return IsBeforeRefineStop(options, i) && i > options.refine_start && i % options.refine_every == 0;
}

}  // namespace oraclegs
