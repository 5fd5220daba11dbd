#include "oraclegs/core/shard_index.h"

#include <string_view>

#include "oraclegs/core/error.h"
#include "oraclegs/core/files.h"
#include "oraclegs/core/unique_json.h"

namespace oraclegs {
namespace {

constexpr std::string_view kIndexEnding = ".safetensors.index.json", kPartEnding = ".safetensors";
constexpr uint64_t kMaxIndexBytes = 100'000'000;

bool IsPartName(std::string_view name) {
  return name.size() > kPartEnding.size() && name.ends_with(kPartEnding) && name.front() != '.' &&
         name.find_first_of(std::string_view("/\\\0", 3)) == std::string_view::npos;
}

}  // namespace

bool IsShardIndex(const std::filesystem::path& path) { return path.string().ends_with(kIndexEnding); }

std::map<std::string, std::set<std::string>> ReadShardIndex(const std::filesystem::path& path) {
  const std::string file = path.string();
  const nlohmann::json index = ParseUniqueJson(ReadFile(path, kMaxIndexBytes), file, "index");
  if (!index.is_object() || !index.contains("weight_map") || !index["weight_map"].is_object()) {
    throw InputError("{}: has no weight_map, which says where each tensor is; get the file again", file);
  }
  std::map<std::string, std::set<std::string>> parts;
  for (const auto& [tensor, part] : index["weight_map"].items()) {
    if (!part.is_string() || !IsPartName(part.get_ref<const std::string&>())) {
      const std::string found = part.is_string() ? QuotedForMessage(part.get<std::string>()) : "no text";
      throw InputError("{}: seeks tensor {} in {}, expected the name of a .safetensors file beside it; get it again",
                       file, QuotedForMessage(tensor), found);
    }
    parts[part.get<std::string>()].insert(tensor);
  }
  if (parts.empty()) throw InputError("{}: its weight_map is empty; get the file again", file);
  return parts;
}

}  // namespace oraclegs
