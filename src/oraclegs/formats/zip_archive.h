#pragma once

#include <map>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace oraclegs {

/// A zip archive of (name, bytes) in this order, stored as they are; the same bytes every time. Those of a file begin
/// at a multiple of `alignment`. Throws RunError.
std::string WriteZip(const std::vector<std::pair<std::string, std::string>>& files, size_t alignment = 1);

/// The files of an archive by name. Throws InputError naming `archive`: no zip, damaged, encrypted, more files than
/// `max_files`, or many times larger unpacked than packed.
std::map<std::string, std::string> ReadZip(std::string_view bytes, int64_t max_files, const std::string& archive);

}  // namespace oraclegs
