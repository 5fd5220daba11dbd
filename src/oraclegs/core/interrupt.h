#pragma once

namespace oraclegs {

/// Makes SIGINT, SIGTERM and SIGHUP (a terminal that is closed) ask for a clean stop; a second SIGINT or SIGTERM ends
/// the process at once. A SIGHUP that is ignored stays so. Call once, from main.
void InstallInterruptHandlers();

/// True once a stop was asked for. Long loops poll it at safe points.
bool InterruptRequested();

/// Throws Interrupted when a stop was asked for.
void ThrowIfInterrupted();

/// Sets or clears the request; for tests and embedding programs.
void RequestInterrupt(bool on);

}  // namespace oraclegs
