#include "oraclegs/core/interrupt.h"

#include <atomic>
#include <csignal>

#include "oraclegs/core/error.h"

namespace oraclegs {
namespace {

std::atomic<bool> g_interrupted = false;  // threads ask, too
static_assert(std::atomic<bool>::is_always_lock_free);

void OnSignal(int signal) {
  g_interrupted = true;
  // The user who asks twice means it; a terminal that is closed may say so twice, its shell and the kernel each.
  if (signal != SIGHUP) std::signal(signal, SIG_DFL);
}

}  // namespace

void InstallInterruptHandlers() {
  std::signal(SIGINT, OnSignal);
  std::signal(SIGTERM, OnSignal);
  if (std::signal(SIGHUP, OnSignal) == SIG_IGN) std::signal(SIGHUP, SIG_IGN);  // nohup
}

bool InterruptRequested() { return g_interrupted; }

void ThrowIfInterrupted() {
  if (InterruptRequested()) throw Interrupted("interrupted");
}

void RequestInterrupt(bool on) { g_interrupted = on; }

}  // namespace oraclegs
