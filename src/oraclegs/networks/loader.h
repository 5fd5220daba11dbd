#pragma once
// Finds the library of networks (networks.h) and loads it when a network is asked for, once a process.

#include <filesystem>
#include <string>

#include "oraclegs/networks/networks.h"

namespace oraclegs {

/// Names the file to load, in place of the search.
inline constexpr const char* kNetworksVariable = "ORACLEGS_NETWORKS_LIBRARY";

/// The networks: liboraclegs_networks.so beside the program's other libraries, in ../lib or ../lib/oraclegs beside the
/// program, or what $ORACLEGS_NETWORKS_LIBRARY names. Stays loaded. Safe from several threads. Throws UsageError when
/// there is none, when it was made by another build, or when it does not load; the message says what brings it.
const Networks& GetNetworks();

/// True when there is a library to load. Looks for the file only: whether it loads is known when a network is asked
/// for.
bool HasNetworksLibrary();

/// Throws UsageError "--oracle vggt needs networks, and ... is not here; ..." where there is none, before hours of
/// work.
void RequireNetworksLibrary(const std::string& needs);

/// Why GetNetworks would throw, in its words; empty when it would not. Loads the library where it can.
std::string WhyNoNetworks();

/// The factory of one library file, which stays loaded. Throws UsageError as GetNetworks does.
const Networks& LoadNetworks(const std::filesystem::path& library);

}  // namespace oraclegs
