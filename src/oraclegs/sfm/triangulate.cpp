#include "oraclegs/sfm/register_views.h"

#include <fmt/format.h>

#include <algorithm>
#include <map>
#include <nlohmann/json.hpp>
#include <set>
#include <string>

#include "oraclegs/core/error.h"
#include "oraclegs/core/subprocess.h"
#include "oraclegs/core/text.h"
#include "oraclegs/scene/colmap_files.h"
#include "oraclegs/scene/colmap_model.h"
#include "oraclegs/scene/read_colmap.h"
#include "oraclegs/scene/scene.h"
#include "oraclegs/sfm/choose_pairs.h"
#include "oraclegs/sfm/colmap_database.h"
#include "oraclegs/sfm/colmap_runner.h"
#include "oraclegs/sfm/colmap_staging.h"
#include "oraclegs/sfm/colmap_workspace.h"
#include "oraclegs/sfm/database_file.h"
#include "oraclegs/sfm/known_poses.h"

namespace oraclegs {
namespace {

namespace fs = std::filesystem;

// Matching takes longest, and longer with each feature. Where poses are known, the points are only a hint of where
// surfaces are: many large photos show enough of them without the features of enlarged images.
constexpr size_t kManyViews = 8;
constexpr int kLargeSide = 800;        // px
constexpr size_t kEnoughPoints = 100;  // a view; where fewer are found, the usual features are looked for

bool AreManyAndLarge(const Scene& scene, const std::vector<int>& views) {
  return views.size() >= kManyViews && std::all_of(views.begin(), views.end(), [&](int v) {
           const Intrinsics& of = scene.views[static_cast<size_t>(v)].intrinsics;
           return std::max(of.width, of.height) >= kLargeSide;
         });
}

/// A text model of the given poses with the ids the database has. Returns its number of images.
size_t WriteKnownPoses(const Scene& scene, const std::vector<int>& views, const std::vector<StagedView>& plan,
                       const ColmapRunner& colmap, const fs::path& dir) {
  const auto stored = ReadDatabaseImages(colmap.database());
  ColmapCameras cameras;
  std::vector<ColmapImage> images;
  for (size_t i = 0; i < views.size(); ++i) {
    const auto found = stored.find(plan[i].name);
    if (found == stored.end()) continue;  // colmap could not use this image and logged why
    const SceneView& view = scene.views[views[i]];
    cameras[found->second.camera_id] = view.intrinsics;
    images.push_back({found->second.image_id, plan[i].name, found->second.camera_id, *view.cam_from_world});
  }
  SetDatabaseCameras(colmap.database(), cameras);
  WriteColmapText(dir, cameras, images);
  return images.size();
}

/// Whether a registration has features of all these views, found in images that were not turned for it.
bool HasFeatures(const fs::path& registered, const Scene& scene, const std::vector<int>& views,
                 const std::vector<StagedView>& plan) {
  std::error_code ignored;
  if (registered.empty() || !fs::exists(registered / "database.db", ignored)) return false;
  try {
    const auto stored = ReadDatabaseImages(registered / "database.db");
    const ColmapCameras cameras = ReadColmapCameras(registered / "sparse" / "0");
    for (size_t i = 0; i < views.size(); ++i) {
      const auto found = stored.find(plan[i].name);
      const auto camera = found == stored.end() ? cameras.end() : cameras.find(found->second.camera_id);
      const Intrinsics& intrinsics = scene.views[static_cast<size_t>(views[i])].intrinsics;
      if (camera == cameras.end() || camera->second.width != intrinsics.width ||
          camera->second.height != intrinsics.height) {
        return false;
      }
    }
  } catch (const Error&) {
    return false;  // they are found again
  }
  return true;
}

/// Gives the database's images the known poses, and writes them for TriangulateMatches.
void TakePoses(const Scene& scene, const std::vector<int>& views, const std::vector<StagedView>& plan,
               const fs::path& work_dir, const ColmapRunner& colmap) {
  if (WriteKnownPoses(scene, views, plan, colmap, AttemptsFolder(work_dir) / "poses") < 2) {
    throw ColmapFailure{"feature_extractor", 0, "fewer than two photos could be used"};
  }
}

/// The model of the database's matches, in a folder that it returns.
fs::path TriangulateMatches(const fs::path& work_dir, const ColmapRunner& colmap) {
  fs::path made = AttemptsFolder(work_dir) / "model";
  MakeFolder(made);
  TriangulateAtPoses(colmap, AttemptsFolder(work_dir) / "poses", made);
  return made;
}

void Triangulate(const Scene& scene, const std::vector<int>& views, const std::vector<StagedView>& plan,
                 const TriangulationFolders& folders, const Listener& listener) {
  const fs::path& work_dir = folders.work;
  const ColmapRunner colmap(work_dir, listener, "sfm");
  MakeFolder(AttemptsFolder(work_dir));
  const bool has_masks = StageImages(scene, views, plan, work_dir);
  const auto with_own_features = [&](const ColmapOptions& options) {
    colmap.ExtractFeatures("SIMPLE_PINHOLE", has_masks, options);  // the true cameras are set afterwards
    TakePoses(scene, views, plan, work_dir, colmap);
    MatchImages(colmap, {}, listener);
    return TriangulateMatches(work_dir, colmap);
  };
  fs::path made;
  if (HasFeatures(folders.registered, scene, views, plan)) {
    CopyDatabase(folders.registered / "database.db", colmap.database());
    TakePoses(scene, views, plan, work_dir, colmap);
    made = TriangulateMatches(work_dir, colmap);
  } else if (AreManyAndLarge(scene, views)) {
    try {
      made = with_own_features({{"SiftExtraction.first_octave", "0"}});
      if (ReadColmapPoints(made).size() < kEnoughPoints * views.size()) made.clear();
    } catch (const ColmapFailure&) {  // where the program is at fault, it fails once more
      made.clear();
    }
    if (made.empty()) RemoveDatabase(colmap.database());
  }
  if (made.empty()) made = with_own_features({});
  MoveTo(made, work_dir / "sparse" / "0");
}

}  // namespace

std::vector<ScenePoint> TriangulatePoints(const Scene& scene, const std::vector<int>& views,
                                          const TriangulationFolders& folders, const Listener& listener) {
  const fs::path& work_dir = folders.work;
  const nlohmann::json inputs = DescribeInputs(scene, views);
  const std::vector<StagedView> plan = PlanStaging(scene, views);
  if (IsUnchanged(work_dir, inputs)) {
    try {
      RestoreImages(scene, views, plan, work_dir);
      return ReadModel(scene, views, plan, work_dir, Silent()).points;
    } catch (const InputError& damage) {
      listener(Warning{fmt::format("{}; the points are triangulated again", damage.what())});
    }
  }
  if (const std::string failed = RememberedFailure(work_dir, inputs); !failed.empty()) {
    listener(Warning{failed});
    return {};
  }
  if (!ColmapAvailable()) {
    listener(Warning{"the colmap program is not installed (Debian: apt install colmap): no points are triangulated"});
    return {};
  }
  ClearWorkDir(work_dir);
  try {
    Triangulate(scene, views, plan, folders, listener);
  } catch (const ColmapFailure& failure) {
    const std::string warning =
        fmt::format("no points are triangulated, as happens when photos match nowhere or poses are wrong: {}; see {}",
                    failure.Text(), (work_dir / "colmap.log").string());
    if (failure.exit_code != kCannotStart) RememberFailure(work_dir, inputs, warning);  // of it the inputs are no cause
    listener(Warning{warning});
    return {};
  }
  std::vector<ScenePoint> points = ReadModel(scene, views, plan, work_dir, listener).points;
  WritePointPly(work_dir / "points.ply", points);
  MarkDone(work_dir, inputs);
  RemoveAttempts(work_dir);
  listener(
      Note{fmt::format("triangulated {} from {}", Counted(points.size(), "point"), Counted(views.size(), "view"))});
  return points;
}

std::vector<ScenePoint> PointsSeenBy(const Scene& scene, const std::vector<int>& views) {
  const std::set<int> allowed(views.begin(), views.end());
  std::vector<ScenePoint> points;
  for (const ScenePoint& point : scene.points) {
    const auto seen =
        std::count_if(point.views.begin(), point.views.end(), [&](int v) { return allowed.count(v) > 0; });
    if (seen >= 2) points.push_back(point);
  }
  return points;
}

}  // namespace oraclegs
