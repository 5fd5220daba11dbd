#pragma once
// The folder one run of structure from motion works in, and how a later run knows that it may use the result.

#include <filesystem>
#include <map>
#include <nlohmann/json_fwd.hpp>
#include <string>
#include <vector>

#include "oraclegs/core/progress.h"
#include "oraclegs/scene/scene.h"
#include "oraclegs/sfm/colmap_staging.h"

namespace oraclegs {

/// True when work_dir holds a finished result of exactly these inputs (see MarkDone).
bool IsUnchanged(const std::filesystem::path& work_dir, const nlohmann::json& inputs);
/// Writes inputs.json, the last file of a run: its presence says that the rest is whole.
void MarkDone(const std::filesystem::path& work_dir, const nlohmann::json& inputs);
/// The failure of colmap on these inputs, which it would meet again; empty when it did not fail, or when another colmap
/// stands there now.
std::string RememberedFailure(const std::filesystem::path& work_dir, const nlohmann::json& inputs);
/// Writes failure.json. Throws RunError.
void RememberFailure(const std::filesystem::path& work_dir, const nlohmann::json& inputs, const std::string& text);
/// Makes work_dir and removes what an earlier run left there, and nothing else. Throws RunError.
void ClearWorkDir(const std::filesystem::path& work_dir);
/// Where attempts keep what only they need (databases, models, lists of pairs), one folder for all of them.
std::filesystem::path AttemptsFolder(const std::filesystem::path& work_dir);
/// Makes the folder of attempts, in an emptied work_dir, unless one is there that was begun with these inputs. Throws
/// RunError.
void BeginAttempts(const std::filesystem::path& work_dir, const nlohmann::json& inputs);
/// Throws RunError.
void RemoveAttempts(const std::filesystem::path& work_dir);
/// Stages the images of a finished result again when a link to one is broken: they were moved since.
void RestoreImages(const Scene& scene, const std::vector<int>& views, const std::vector<StagedView>& plan,
                   const std::filesystem::path& work_dir);
/// Creates a folder and its parents. Throws RunError.
void MakeFolder(const std::filesystem::path& dir);
/// Renames a file or folder, in place of what stands at `to`. Throws RunError.
void MoveTo(const std::filesystem::path& from, const std::filesystem::path& to);

/// The model in work_dir/sparse/0 in terms of `scene`: which of its views the model's images are, and the points with
/// indices of `scene`.
struct ModelInScene {
  std::map<int, SceneView> views;  ///< by index into Scene::views; intrinsics and pose are the model's
  std::vector<ScenePoint> points;
};

/// Throws InputError when the model is missing or damaged, or holds images that are not in the plan.
ModelInScene ReadModel(const Scene& scene, const std::vector<int>& views, const std::vector<StagedView>& plan,
                       const std::filesystem::path& work_dir, const Listener& listener);

/// The model's views and points as a scene of format kColmap; `photos` is what it was made of.
Scene RegisteredScene(const Scene& photos, ModelInScene model);

}  // namespace oraclegs
