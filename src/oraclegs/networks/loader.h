#pragma once
// Finds the library of networks (networks.h) and loads it when a network is asked for, once a process.

#include <filesystem>
#include <string>

#include "oraclegs/networks/networks.h"

namespace oraclegs {

/// Environment variable that names the file to load, in place of the search.
inline constexpr const char* kNetworksVariable = "ORACLEGS_NETWORKS_LIBRARY";

/// Loads and returns the networks: the file that $ORACLEGS_NETWORKS_LIBRARY names, else liboraclegs_networks.so beside
/// the program's other libraries, in ../lib or ../lib/oraclegs beside the program. It stays loaded. Safe from several
/// threads. Throws UsageError when there is none, when it is of another build, or when it does not load; the message
/// says how to get it.
const Networks& GetNetworks();

/// True when there is a library file. Whether it loads shows when a network is asked for.
bool HasNetworksLibrary();

/// Throws UsageError "--oracle vggt needs networks, and ... is not here; ..." where there is none. Call it before work
/// that takes hours.
void RequireNetworksLibrary(const std::string& needs);

/// Message of the error that GetNetworks would throw; empty when it would not. Loads the library where it can.
std::string WhyNoNetworks();

/// Factory of one library file, which stays loaded. Throws UsageError as GetNetworks does.
const Networks& LoadNetworks(const std::filesystem::path& library);

}  // namespace oraclegs
