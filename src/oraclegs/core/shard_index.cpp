#include "oraclegs/core/shard_index.h"

#include <string_view>

#include "oraclegs/core/error.h"
#include "oraclegs/core/files.h"
#include "oraclegs/core/unique_json.h"

namespace oraclegs {
namespace {

constexpr std::string_view kIndexEnding = ".index.json", kSafetensors = ".safetensors", kTorch = ".bin";
constexpr uint64_t kMaxIndexBytes = 100'000'000;

bool IsIndexOf(std::string_view parts, const std::filesystem::path& path) {
  return path.string().ends_with(std::string(parts) + std::string(kIndexEnding));
}

bool IsPartName(std::string_view name, std::string_view ending) {
  return name.size() > ending.size() && name.ends_with(ending) && name.front() != '.' &&
         name.find_first_of(std::string_view("/\\\0", 3)) == std::string_view::npos;
}

}  // namespace

bool IsShardIndex(const std::filesystem::path& path) { return IsIndexOf(kSafetensors, path); }
bool IsTorchShardIndex(const std::filesystem::path& path) { return IsIndexOf(kTorch, path); }

std::map<std::string, std::set<std::string>> ReadShardIndex(const std::filesystem::path& path) {
  const std::string file = path.string();
  const nlohmann::json index = ParseUniqueJson(ReadFile(path, kMaxIndexBytes), file, "index");
  if (!index.is_object() || !index.contains("weight_map") || !index["weight_map"].is_object()) {
    throw InputError("{}: has no weight_map, which says where each tensor is; get the file again", file);
  }
  const std::string_view ending = IsTorchShardIndex(path) ? kTorch : kSafetensors;
  std::map<std::string, std::set<std::string>> parts;
  for (const auto& [tensor, part] : index["weight_map"].items()) {
    if (!part.is_string() || !IsPartName(part.get_ref<const std::string&>(), ending)) {
      const std::string found = part.is_string() ? QuotedForMessage(part.get<std::string>()) : "no text";
      throw InputError("{}: seeks tensor {} in {}, expected the name of a {} file beside it; get it again", file,
                       QuotedForMessage(tensor), found, ending);
    }
    parts[part.get<std::string>()].insert(tensor);
  }
  if (parts.empty()) throw InputError("{}: its weight_map is empty; get the file again", file);
  return parts;
}

}  // namespace oraclegs
