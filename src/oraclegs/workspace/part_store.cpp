#include "oraclegs/workspace/part_store.h"

#include <utility>
#include <vector>

#include "oraclegs/core/atomic_file.h"
#include "oraclegs/core/error.h"
#include "oraclegs/core/files.h"
#include "oraclegs/core/system_reason.h"
#include "oraclegs/workspace/saved_run.h"

namespace oraclegs {
namespace {

namespace fs = std::filesystem;

constexpr const char* kRecord = "part.json";

/// A folder that is gone at the end of the scope, unless it was renamed.
struct HalfPart {
  fs::path path;
  ~HalfPart() {
    std::error_code ignored;
    fs::remove_all(path, ignored);
  }
};

/// Regular files below a folder, relative to it.
std::vector<fs::path> FilesBelow(const fs::path& folder) {
  std::vector<fs::path> files;
  std::error_code ignored;
  for (const auto& entry : fs::recursive_directory_iterator(folder, ignored)) {
    if (entry.is_regular_file(ignored) && !entry.is_symlink(ignored)) files.push_back(entry.path());
  }
  for (fs::path& file : files) file = file.lexically_relative(folder);
  return files;
}

}  // namespace

PartStore::PartStore(const WorkspacePaths& paths, const std::string& stage, std::string key)
    : root_(paths.root()), folder_(paths.parts() / stage), key_(std::move(key)) {}

fs::path PartStore::FolderOf(size_t number) const { return folder_ / std::to_string(number); }

void PartStore::Make(size_t number, FunctionRef<nlohmann::json(const fs::path& folder)> fill) const {
  // Another process may be at the same part, where a cluster has lost sight of it.
  const HalfPart folder{folder_ / TemporaryName()};
  const fs::path &half = folder.path, whole = FolderOf(number);
  std::error_code error;
  fs::create_directories(half, error);
  if (error) throw RunError("{}: cannot be made: {}", half.string(), SystemReason(error));
  nlohmann::json record = fill(half);
  record["key"] = key_;
  WriteFileAtomically(half / kRecord, record.dump() + "\n");
  fs::remove_all(whole, error);
  fs::rename(half, whole, error);
  if (error) throw RunError("{}: cannot be made: {}", whole.string(), SystemReason(error));
}

nlohmann::json PartStore::RecordOf(size_t number) const {
  std::error_code ignored;
  if (!fs::exists(FolderOf(number) / kRecord, ignored)) return nullptr;
  try {
    nlohmann::json record = ReadRunJson(FolderOf(number) / kRecord);
    return record.is_object() && record.value("key", nlohmann::json()) == key_ ? record : nullptr;
  } catch (const InputError&) {
    return nullptr;
  }
}

bool PartStore::Has(size_t number) const { return !RecordOf(number).is_null(); }

std::optional<nlohmann::json> PartStore::Take(size_t number) const {
  nlohmann::json record = RecordOf(number);
  if (record.is_null()) return std::nullopt;
  const fs::path folder = FolderOf(number);
  std::error_code error, ignored;
  fs::remove(folder / kRecord, error);  // half of a part is none
  for (const fs::path& file : FilesBelow(folder)) {
    fs::create_directories((root_ / file).parent_path(), ignored);
    if (!error) fs::rename(folder / file, root_ / file, error);
  }
  fs::remove_all(folder, ignored);
  if (error) return std::nullopt;
  return record;
}

void PartStore::Clear() const {
  std::error_code ignored;
  fs::remove_all(folder_, ignored);
}

}  // namespace oraclegs
