#pragma once

#include <chrono>
#include <functional>
#include <thread>

namespace oraclegs {

/// Waits until the condition is true, for two minutes: a test's process may get little of a loaded machine.
inline bool WaitUntil(const std::function<bool()>& is_true) {
  const auto end = std::chrono::steady_clock::now() + std::chrono::minutes(2);
  while (!is_true()) {
    if (std::chrono::steady_clock::now() > end) return is_true();
    std::this_thread::sleep_for(std::chrono::milliseconds(10));
  }
  return true;
}

}  // namespace oraclegs
