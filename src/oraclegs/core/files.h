#pragma once
// Reading whole files, mapping large ones, and writing them so that a reader never sees half of one.

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace oraclegs {

/// The bytes of `path`. Throws InputError naming it when missing, not a regular file, unreadable, or larger than
/// max_bytes.
std::string ReadFile(const std::filesystem::path& path, uint64_t max_bytes = uint64_t{1} << 34);

/// The first bytes of a regular file, at most `bytes`, fewer where it ends; empty where it cannot be read.
std::string ReadHead(const std::filesystem::path& path, size_t bytes);

/// True for a folder and for a link to one; false where that cannot be found out.
bool IsFolder(const std::filesystem::path& path);

/// Writes to a temporary name beside `path`, flushes to disk, renames: `path` holds the old content or all of the new.
/// Creates the parent folder. Throws RunError (disk full, read-only, ...) after removing the temporary file.
void WriteFileAtomically(const std::filesystem::path& path, std::string_view bytes);

/// Replaces a file that changes many times a minute and may be lost: as WriteFileAtomically, but without waiting for
/// the disk, and the folder must be there. Throws RunError.
void ReplaceFile(const std::filesystem::path& path, std::string_view bytes);

/// Creates `dir` and its parents and proves that files can be made in it. Throws RunError naming it and the reason.
void RequireWritableFolder(const std::filesystem::path& dir);

/// A file in memory: up to 64 MiB it is read; of a larger one, such as the weights of a network, pages come when they
/// are looked at, and a program that shortens it meanwhile ends this one by SIGBUS.
struct MappedFile {
  std::string_view bytes;             ///< valid as long as `owner` lives
  std::shared_ptr<const void> owner;  ///< of the memory, which nobody writes to
};

/// Throws InputError naming `path` when it cannot be opened or read, is not a regular file, is empty or cannot be
/// mapped.
MappedFile MapFile(const std::filesystem::path& path);

/// Full path of a program in PATH, empty when there is none.
std::filesystem::path FindProgram(const std::string& name);

/// A shared library that belongs to this program and is loaded when it is needed: beside liboraclegs_core.so, beside
/// the program, in ../lib or in ../lib/oraclegs. Nothing when there is none.
std::optional<std::filesystem::path> FindLibraryFile(const std::string& name);

}  // namespace oraclegs
