#pragma once
// A file in memory: up to 64 MiB it is read; of a larger one, such as the weights of a network, pages come when they
// are looked at, and a program that shortens it meanwhile ends this one by SIGBUS.

#include <filesystem>
#include <memory>
#include <string_view>

namespace oraclegs {

struct MappedFile {
  std::string_view bytes;             ///< valid as long as `owner` lives
  std::shared_ptr<const void> owner;  ///< holds the memory, which nobody writes to
};

/// Throws InputError naming `path` when it cannot be opened or read, is not a regular file, is empty or cannot be
/// mapped.
MappedFile MapFile(const std::filesystem::path& path);

}  // namespace oraclegs
