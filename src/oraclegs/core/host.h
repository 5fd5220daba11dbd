#pragma once

#include <string>

namespace oraclegs {

/// The name of this machine as it can stand in a file's name: letters, digits, '.', '_' and '-' alone. "unknown" where
/// it has none. Numbers of processes mean something together with it only, where machines share a folder.
const std::string& HostName();

}  // namespace oraclegs
