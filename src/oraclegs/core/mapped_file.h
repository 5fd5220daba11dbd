#pragma once
// A file in memory without reading it: pages come when they are looked at.

#include <filesystem>
#include <memory>
#include <string_view>

namespace oraclegs {

struct MappedFile {
  std::string_view bytes;             ///< valid as long as `owner` lives
  std::shared_ptr<const void> owner;  ///< of the mapping, which nobody writes to
};

/// Throws InputError naming `path` when it cannot be opened, is not a regular file, is empty or cannot be mapped.
MappedFile MapFile(const std::filesystem::path& path);

}  // namespace oraclegs
