#pragma once
// A run in 3D before it trains.

#include <string>

#include "oraclegs/gaussians/gaussians.h"
#include "oraclegs/stages/stage.h"

namespace oraclegs {

struct EarlySplat {
  std::string of;       ///< "sparse points", "dense points" or "draft model"
  Gaussians gaussians;  ///< empty = this stage has nothing new to show
};

/// Shows a stage that is finished: the points that it found as small Gaussians, at most 100 000 of them, or the first
/// proxy model.
EarlySplat EarlySplatOf(const Run& run, const std::string& stage);

}  // namespace oraclegs
