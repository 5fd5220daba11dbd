#pragma once
// Reading whole files and writing them so that a reader never sees half of one.

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

namespace oraclegs {

/// The bytes of `path`. Throws InputError naming it when missing, not a regular file, unreadable, or larger than
/// max_bytes.
std::string ReadFile(const std::filesystem::path& path, uint64_t max_bytes = uint64_t{1} << 34);

/// Writes to a temporary name beside `path`, flushes to disk, renames: `path` holds the old content or all of the new.
/// Creates the parent folder. Throws RunError (disk full, read-only, ...) after removing the temporary file.
void WriteFileAtomically(const std::filesystem::path& path, std::string_view bytes);

/// The same for what is replaced many times a minute and lost without harm: it does not wait for the disk, and the
/// folder must be there.
void ReplaceFile(const std::filesystem::path& path, std::string_view bytes);

/// Creates `dir` and its parents and proves that files can be made in it. Throws RunError naming it and the reason.
void RequireWritableFolder(const std::filesystem::path& dir);

}  // namespace oraclegs
