#pragma once

namespace oraclegs {

/// Makes SIGINT and SIGTERM ask for a clean stop; a second signal ends the process at once. Call once, from main.
void InstallInterruptHandlers();

/// True once a stop was asked for. Long loops poll it at safe points.
bool InterruptRequested();

/// Throws Interrupted when a stop was asked for.
void ThrowIfInterrupted();

/// Sets or clears the request; for tests and embedding programs.
void RequestInterrupt(bool on);

}  // namespace oraclegs
