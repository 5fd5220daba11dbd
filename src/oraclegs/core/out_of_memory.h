#pragma once

#include "oraclegs/core/error.h"

namespace oraclegs {

/// Memory ended: the message says how much of it for what, and which options lower it. Whoever catches it may go on.
class OutOfMemory : public RunError {
 public:
  using RunError::RunError;
};

}  // namespace oraclegs
