#pragma once

#include "oraclegs/core/error.h"

namespace oraclegs {

/// A loss or a parameter is not a number any more. Nothing is saved from then on.
class Diverged : public RunError {
 public:
  using RunError::RunError;
};

}  // namespace oraclegs
