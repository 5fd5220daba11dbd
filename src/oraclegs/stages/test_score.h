#pragma once

#include "oraclegs/stages/run_observer.h"
#include "oraclegs/stages/stage.h"

namespace oraclegs {

/// How --eval-every scores the run's test views while it trains; never, without it or without test views. Loads them.
TestScore TestScoreOf(const Run& run);

}  // namespace oraclegs
