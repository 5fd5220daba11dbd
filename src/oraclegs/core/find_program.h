#pragma once

#include <filesystem>
#include <optional>
#include <string>

namespace oraclegs {

/// Full path of a program in PATH, empty when there is none.
std::filesystem::path FindProgram(const std::string& name);

/// A shared library that belongs to this program and is loaded when it is needed: beside liboraclegs_core.so, beside
/// the program, in ../lib or in ../lib/oraclegs. Nothing when there is none.
std::optional<std::filesystem::path> FindLibraryFile(const std::string& name);

}  // namespace oraclegs
