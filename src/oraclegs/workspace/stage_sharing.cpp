#include "oraclegs/workspace/stage_sharing.h"

#include <algorithm>
#include <string>
#include <string_view>

#include "oraclegs/core/atomic_file.h"
#include "oraclegs/workspace/stage_records.h"

namespace oraclegs {
namespace {

namespace fs = std::filesystem;

/// Folders, and the stages that fill them: the records whose names begin so, the decisive one first.
struct Portion {
  std::vector<const char*> folders, stages;
};

const Portion kRegistration = {{"sfm", "masks"}, {"register", "masks"}};
const Portion kGeometry = {{"sfm", "depth", "masks"}, {"depth", "sfm", "register", "poses", "masks"}};
const Portion kProposals = {{"proposals", "confidence"}, {"propose", "validate", "proxies", "proxy "}};

bool HasAny(const fs::path& root, const Portion& portion) {
  std::error_code ignored;
  return std::any_of(portion.folders.begin(), portion.folders.end(),
                     [&](const char* folder) { return fs::exists(root / folder, ignored); });
}

bool IsOf(const std::string& record, const Portion& portion) {
  return std::any_of(portion.stages.begin(), portion.stages.end(),
                     [&](std::string_view stage) { return record.compare(0, stage.size(), stage) == 0; });
}

/// The whole folder or nothing.
bool CopyFolder(const fs::path& from, const fs::path& to) {
  std::error_code error;
  if (!fs::exists(from, error)) return true;
  const fs::path half = to.parent_path() / TemporaryName();
  fs::copy(from, half, fs::copy_options::recursive | fs::copy_options::copy_symlinks, error);
  if (!error) fs::rename(half, to, error);
  if (!error) return true;
  std::error_code ignored;
  fs::remove_all(half, ignored);
  return false;
}

void Copy(Workspace* workspace, const fs::path& donor, const Portion& portion) {
  const nlohmann::json records = ReadStageRecords(donor);
  for (const char* folder : portion.folders) {
    if (!CopyFolder(donor / folder, workspace->root() / folder)) return;
  }
  for (const auto& [stage, record] : records.items()) {
    if (IsOf(stage, portion)) workspace->MarkDone(stage, record);
  }
}

void TakeOver(Workspace* workspace, const std::vector<fs::path>& donors, const Portion& portion) {
  if (HasAny(workspace->root(), portion)) return;
  for (const char* stage : portion.stages) {
    for (const fs::path& donor : donors) {
      if (donor == workspace->root() || !ReadStageRecords(donor).contains(stage)) continue;
      try {
        const Workspace held = Workspace::Open(donor);  // nobody else may change it meanwhile
        return Copy(workspace, donor, portion);
      } catch (const InputError&) {
      } catch (const RunError&) {
      }
    }
  }
}

}  // namespace

void TakeOverRegistration(Workspace* workspace, const std::vector<fs::path>& donors) {
  TakeOver(workspace, donors, kRegistration);
}

void TakeOverGeometry(Workspace* workspace, const std::vector<fs::path>& donors) {
  TakeOver(workspace, donors, kGeometry);
}

void TakeOverProposals(Workspace* workspace, const std::vector<fs::path>& donors) {
  TakeOver(workspace, donors, kProposals);
}

}  // namespace oraclegs
