#pragma once

#include "oraclegs/core/error.h"

namespace oraclegs {

/// Error of a training whose loss or parameters became NaN or infinite. Nothing is saved from then on.
class Diverged : public RunError {
 public:
  using RunError::RunError;
};

}  // namespace oraclegs
