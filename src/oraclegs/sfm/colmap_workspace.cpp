#include "oraclegs/sfm/colmap_workspace.h"

#include <algorithm>
#include <nlohmann/json.hpp>
#include <string>
#include <system_error>
#include <utility>

#include "oraclegs/core/error.h"
#include "oraclegs/core/files.h"
#include "oraclegs/core/folder_lock.h"
#include "oraclegs/core/text.h"
#include "oraclegs/core/unique_json.h"
#include "oraclegs/scene/colmap_model.h"
#include "oraclegs/scene/read_colmap.h"
#include "oraclegs/scene/scene.h"

namespace oraclegs {
namespace {

namespace fs = std::filesystem;

constexpr char kInputs[] = "inputs.json", kFailure[] = "failure.json";

void Remove(const fs::path& path) {
  std::error_code error;
  fs::remove_all(path, error);
  if (error) throw RunError("{}: cannot be removed: {}", path.string(), SystemReason(error));
}

/// True when the file holds exactly these inputs.
bool Holds(const fs::path& file, const nlohmann::json& inputs) {
  std::error_code error;
  if (!fs::exists(file, error)) return false;
  try {
    return ParseJson(ReadFile(file)) == inputs;
  } catch (const std::exception&) {
    return false;  // damaged: made anew
  }
}

/// The program that fails: once another stands there, it is tried again.
nlohmann::json ColmapStamp() {
  const fs::path program = FindProgram("colmap");
  std::error_code ignored;
  return {{"program", EscapeBytes(program.string())},
          {"bytes", fs::file_size(program, ignored)},
          {"modified", fs::last_write_time(program, ignored).time_since_epoch().count()}};
}

/// From the camera of the photo turned clockwise by 90 degrees, of one focal length, to that of the photo as it is.
void TurnBack(SceneView* view) {
  Intrinsics& intrinsics = view->intrinsics;
  if (intrinsics.model != CameraModel::kSimpleRadial) {
    throw InputError("{}: the model has a camera that was not made here; delete sfm/", view->image_path.string());
  }
  const double cx = intrinsics.params[1], cy = intrinsics.params[2];
  intrinsics.params[1] = cy;
  intrinsics.params[2] = intrinsics.width - cx;
  std::swap(intrinsics.width, intrinsics.height);
  Eigen::Isometry3d upright_from_turned = Eigen::Isometry3d::Identity();
  upright_from_turned.linear() << 0, 1, 0, -1, 0, 0, 0, 0, 1;
  view->cam_from_world = upright_from_turned * *view->cam_from_world;
}

}  // namespace

bool IsUnchanged(const fs::path& work_dir, const nlohmann::json& inputs) { return Holds(work_dir / kInputs, inputs); }

std::string RememberedFailure(const fs::path& work_dir, const nlohmann::json& inputs) {
  std::error_code ignored;
  if (!fs::exists(work_dir / kFailure, ignored)) return "";
  try {
    const nlohmann::json failure = ParseJson(ReadFile(work_dir / kFailure));
    if (failure.at("inputs") != inputs || failure.at("colmap") != ColmapStamp()) return "";
    return failure.at("text").get<std::string>();
  } catch (const std::exception&) {
    return "";  // damaged: it is tried again
  }
}

void RememberFailure(const fs::path& work_dir, const nlohmann::json& inputs, const std::string& text) {
  const nlohmann::json failure = {{"inputs", inputs}, {"colmap", ColmapStamp()}, {"text", text}};
  WriteFileAtomically(work_dir / kFailure,
                      failure.dump(1, ' ', false, nlohmann::json::error_handler_t::replace) + "\n");
}

void MarkDone(const fs::path& work_dir, const nlohmann::json& inputs) {
  WriteFileAtomically(work_dir / kInputs, inputs.dump(1) + "\n");
}

void ClearWorkDir(const fs::path& work_dir) {
  RequireWritableFolder(work_dir);
  for (const char* name : {kInputs, kFailure, "registration.json", "database.db", "database.db-wal", "database.db-shm",
                           "colmap.log", "points.ply", "sparse", "images", "masks"}) {
    Remove(work_dir / name);
  }
  RemoveAttempts(work_dir);
}

fs::path AttemptsFolder(const fs::path& work_dir) { return work_dir / "attempts"; }

void BeginAttempts(const fs::path& work_dir, const nlohmann::json& inputs) {
  const fs::path begun_with = AttemptsFolder(work_dir) / kInputs;
  if (Holds(begun_with, inputs)) return;
  ClearWorkDir(work_dir);
  MakeFolder(AttemptsFolder(work_dir));
  WriteFileAtomically(begun_with, inputs.dump(1) + "\n");
}

void RemoveAttempts(const fs::path& work_dir) { Remove(AttemptsFolder(work_dir)); }

void RestoreImages(const Scene& scene, const std::vector<int>& views, const std::vector<StagedView>& plan,
                   const fs::path& work_dir) {
  const auto is_there = [&](const StagedView& staged) { return IsFile(work_dir / "images" / staged.name); };
  if (!std::all_of(plan.begin(), plan.end(), is_there)) StageImages(scene, views, plan, work_dir);
}

void MoveTo(const fs::path& from, const fs::path& to) {
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
  std::map<std::string, size_t> index_of;
  for (size_t i = 0; i < plan.size(); ++i) index_of[plan[i].name] = i;
  ModelInScene out;
  std::vector<int> scene_index;
  for (const SceneView& registered : model.views) {
    const auto found = index_of.find(registered.name);
    if (found == index_of.end()) {
      throw InputError("{}: holds the unknown image {}; delete the folder", work_dir.string(), registered.name);
    }
    const int index = views[found->second];
    SceneView view = scene.views[static_cast<size_t>(index)];
    view.intrinsics = registered.intrinsics;
    view.cam_from_world = registered.cam_from_world;
    if (plan[found->second].is_turned) TurnBack(&view);
    out.views[index] = std::move(view);
    scene_index.push_back(index);
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
