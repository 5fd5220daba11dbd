#include "oraclegs/core/interrupt.h"

#include <csignal>

#include "oraclegs/core/error.h"

namespace oraclegs {
namespace {

volatile std::sig_atomic_t g_interrupted = 0;

void OnSignal(int signal) {
  g_interrupted = 1;
  std::signal(signal, SIG_DFL);  // the user who asks twice means it
}

}  // namespace

void InstallInterruptHandlers() {
  std::signal(SIGINT, OnSignal);
  std::signal(SIGTERM, OnSignal);
}

bool InterruptRequested() { return g_interrupted != 0; }

void ThrowIfInterrupted() {
  if (InterruptRequested()) throw Interrupted("interrupted");
}

void RequestInterrupt(bool on) { g_interrupted = on ? 1 : 0; }

}  // namespace oraclegs
