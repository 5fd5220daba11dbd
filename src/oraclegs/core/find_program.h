#pragma once

#include <filesystem>
#include <string>

namespace oraclegs {

/// Full path of a program in PATH, empty when there is none.
std::filesystem::path FindProgram(const std::string& name);

}  // namespace oraclegs
