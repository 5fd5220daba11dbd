#pragma once

#include "oraclegs/baselines/pseudo_depth.h"
#include "oraclegs/baselines/settings.h"
#include "oraclegs/train/trainer.h"

namespace oraclegs {

/// Inputs of a published method's training. AddBaseline (baselines/make_parts.h) makes its densifier and parts of them.
struct BaselineSetup : TrainSetup {
  BaselineSettings baseline = {};
  TrainDeviceMaker make_device = {};  ///< for a second model
  PseudoDepth pseudo_depth = {};      ///< only where pseudo_depth_weight is set
};

}  // namespace oraclegs
