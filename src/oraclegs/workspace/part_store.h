#pragma once
// Parts of a stage that other processes have made, until the stage takes them.
//
//   OUT/parts/STAGE/3/...        files of part 3, with the paths that they are going to have in the workspace
//   OUT/parts/STAGE/3/part.json  its key and what else the stage wants to know of it

#include <filesystem>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>

#include "oraclegs/core/function_ref.h"
#include "oraclegs/workspace/workspace.h"

namespace oraclegs {

class PartStore {
 public:
  /// Of a stage whose inputs have this key: parts of another key are none.
  PartStore(const WorkspacePaths& paths, const std::string& stage, std::string key);

  /// Makes a part, in place of an earlier one: `fill` writes its files to the folder that it is given, with their paths
  /// in the workspace, and returns what else is to be known of it. The part appears when it is whole. Throws RunError
  /// when it cannot be written, and what `fill` throws.
  void Make(size_t number, FunctionRef<nlohmann::json(const std::filesystem::path& folder)> fill) const;

  /// Whether there is a whole part.
  bool Has(size_t number) const;

  /// Moves the files of a part into the workspace and returns what is known of it. Nothing, and no part, where it is
  /// missing, damaged, of another key, or cannot be moved.
  std::optional<nlohmann::json> Take(size_t number) const;

  /// Removes all parts of the stage.
  void Clear() const;

 private:
  std::filesystem::path FolderOf(size_t number) const;
  /// What part.json says; null where the part is none.
  nlohmann::json RecordOf(size_t number) const;

  std::filesystem::path root_, folder_;
  std::string key_;
};

}  // namespace oraclegs
