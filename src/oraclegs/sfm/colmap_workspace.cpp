#include "oraclegs/sfm/colmap_workspace.h"

#include <algorithm>
#include <nlohmann/json.hpp>
#include <string>
#include <system_error>

#include "oraclegs/core/error.h"
#include "oraclegs/core/files.h"
#include "oraclegs/core/folder_lock.h"
#include "oraclegs/core/system_reason.h"
#include "oraclegs/core/unique_json.h"
#include "oraclegs/scene/colmap_model.h"
#include "oraclegs/scene/read_colmap.h"
#include "oraclegs/scene/scene.h"

namespace oraclegs {
namespace {

namespace fs = std::filesystem;

constexpr char kInputs[] = "inputs.json";

void Remove(const fs::path& path) {
  std::error_code error;
  fs::remove_all(path, error);
  if (error) throw RunError("{}: cannot be removed: {}", path.string(), SystemReason(error));
}

}  // namespace

bool IsUnchanged(const fs::path& work_dir, const nlohmann::json& inputs) {
  std::error_code error;
  if (!fs::exists(work_dir / kInputs, error)) return false;
  try {
    return ParseJson(ReadFile(work_dir / kInputs)) == inputs;
  } catch (const std::exception&) {
    return false;  // damaged: made anew
  }
}

void MarkDone(const fs::path& work_dir, const nlohmann::json& inputs) {
  WriteFileAtomically(work_dir / kInputs, inputs.dump(1) + "\n");
}

void ClearWorkDir(const fs::path& work_dir) {
  RequireWritableFolder(work_dir);
  for (const char* name : {kInputs, "failure.json", "registration.json", "database.db", "database.db-wal",
                           "database.db-shm", "colmap.log", "points.ply", "sparse", "images", "masks"}) {
    Remove(work_dir / name);
  }
  RemoveAttempts(work_dir);
}

fs::path AttemptsFolder(const fs::path& work_dir) { return work_dir / "attempts"; }

void RemoveAttempts(const fs::path& work_dir) { Remove(AttemptsFolder(work_dir)); }

void RestoreImages(const Scene& scene, const std::vector<int>& views, const std::vector<StagedView>& plan,
                   const fs::path& work_dir) {
  const auto is_there = [&](const StagedView& staged) { return IsFile(work_dir / "images" / staged.name); };
  if (!std::all_of(plan.begin(), plan.end(), is_there)) StageImages(scene, views, plan, work_dir);
}

void MoveFolder(const fs::path& from, const fs::path& to) {
  std::error_code error;
  fs::create_directories(to.parent_path(), error);
  if (!error) fs::remove_all(to, error);
  if (!error) fs::rename(from, to, error);
  if (error) throw RunError("{}: cannot be renamed to {}: {}", from.string(), to.string(), SystemReason(error));
}

void MakeFolder(const fs::path& dir) {
  RequireHeldFolderOf(dir);
  std::error_code error;
  fs::create_directories(dir, error);
  if (error) throw RunError("{}: cannot be made: {}", dir.string(), SystemReason(error));
}

ModelInScene ReadModel(const Scene& scene, const std::vector<int>& views, const std::vector<StagedView>& plan,
                       const fs::path& work_dir, const Listener& listener) {
  const Scene model = ReadColmapScene(work_dir / "sparse" / "0", work_dir / "images", listener);
  std::map<std::string, int> index_of;
  for (size_t i = 0; i < plan.size(); ++i) index_of[plan[i].name] = views[i];
  ModelInScene out;
  std::vector<int> scene_index;
  for (const SceneView& registered : model.views) {
    const auto found = index_of.find(registered.name);
    if (found == index_of.end()) {
      throw InputError("{}: holds the unknown image {}; delete the folder", work_dir.string(), registered.name);
    }
    SceneView view = scene.views[found->second];
    view.intrinsics = registered.intrinsics;
    view.cam_from_world = registered.cam_from_world;
    out.views[found->second] = std::move(view);
    scene_index.push_back(found->second);
  }
  for (ScenePoint point : model.points) {
    for (int& v : point.views) v = scene_index[v];
    std::sort(point.views.begin(), point.views.end());
    out.points.push_back(std::move(point));
  }
  return out;
}

Scene RegisteredScene(const Scene& photos, ModelInScene model) {
  Scene scene;
  scene.root = photos.root;
  scene.format = SceneFormat::kColmap;
  std::vector<int> new_index(photos.views.size(), -1);
  for (auto& [v, view] : model.views) {
    new_index[v] = static_cast<int>(scene.views.size());
    scene.views.push_back(std::move(view));
  }
  scene.points = std::move(model.points);
  for (ScenePoint& point : scene.points) {
    for (int& v : point.views) v = new_index[v];
  }
  return scene;
}

}  // namespace oraclegs
