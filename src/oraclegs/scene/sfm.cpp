#include "oraclegs/scene/sfm.h"

#include <fmt/format.h>

#include <algorithm>
#include <map>
#include <nlohmann/json.hpp>
#include <set>
#include <string>
#include <system_error>

#include "oraclegs/core/error.h"
#include "oraclegs/core/files.h"
#include "oraclegs/core/subprocess.h"
#include "oraclegs/scene/colmap_database.h"
#include "oraclegs/scene/colmap_model.h"
#include "oraclegs/scene/colmap_runner.h"
#include "oraclegs/scene/colmap_staging.h"

namespace oraclegs {
namespace {

namespace fs = std::filesystem;

constexpr char kInputs[] = "inputs.json";  // written last: its presence says that the rest is whole
constexpr size_t kNamesInMessage = 12;

std::vector<int> AllViews(const Scene& scene) {
  std::vector<int> views(scene.views.size());
  for (size_t i = 0; i < views.size(); ++i) views[i] = static_cast<int>(i);
  return views;
}

bool IsUnchanged(const fs::path& work_dir, const nlohmann::json& inputs) {
  if (!fs::exists(work_dir / kInputs)) return false;
  try {
    return nlohmann::json::parse(ReadFile(work_dir / kInputs)) == inputs;
  } catch (const std::exception&) {
    return false;  // damaged: made anew
  }
}

void ClearWorkDir(const fs::path& work_dir) {
  RequireWritableFolder(work_dir);
  std::error_code error;
  for (const char* name : {kInputs, "database.db", "database.db-wal", "database.db-shm", "colmap.log", "points.ply",
                           "sparse", "poses", "models", "images", "masks"}) {
    fs::remove_all(work_dir / name, error);
    if (error) throw RunError("{}: cannot be removed: {}", (work_dir / name).string(), error.message());
  }
}

void MoveFolder(const fs::path& from, const fs::path& to) {
  std::error_code error;
  fs::create_directories(to.parent_path(), error);
  fs::remove_all(to, error);
  fs::rename(from, to, error);
  if (error) throw RunError("{}: cannot be renamed to {}: {}", from.string(), to.string(), error.message());
}

void MakeFolder(const fs::path& dir) {
  std::error_code error;
  fs::create_directories(dir, error);
  if (error) throw RunError("{}: cannot be made: {}", dir.string(), error.message());
}

std::string JoinNames(std::vector<std::string> names) {
  const size_t more = names.size() > kNamesInMessage ? names.size() - kNamesInMessage : 0;
  names.resize(names.size() - more);
  return fmt::format("{}{}", fmt::join(names, ", "), more > 0 ? fmt::format(" and {} more", more) : "");
}

std::string PointsPly(const std::vector<ScenePoint>& points) {
  std::string ply = fmt::format(
      "ply\nformat ascii 1.0\nelement vertex {}\nproperty float x\nproperty float y\nproperty float z\n"
      "property uchar red\nproperty uchar green\nproperty uchar blue\nend_header\n",
      points.size());
  for (const ScenePoint& p : points) {
    fmt::format_to(std::back_inserter(ply), "{:.9g} {:.9g} {:.9g} {} {} {}\n", p.xyz.x(), p.xyz.y(), p.xyz.z(),
                   p.rgb[0], p.rgb[1], p.rgb[2]);
  }
  return ply;
}

/// The model in work_dir/sparse/0 in terms of `scene`: which of its views the model's images are, and the points with
/// indices of `scene`.
struct ModelInScene {
  std::map<int, SceneView> views;  ///< by index into Scene::views; lens and pose are the model's
  std::vector<ScenePoint> points;
};

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
      throw InputError("{}: holds the unknown photograph {}; delete the folder", work_dir.string(), registered.name);
    }
    SceneView view = scene.views[found->second];
    view.lens = registered.lens;
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

/// A text model of the given poses with the ids the database has. Returns its number of images.
size_t WriteKnownPoses(const Scene& scene, const std::vector<int>& views, const std::vector<StagedView>& plan,
                       const ColmapRunner& colmap, const fs::path& dir) {
  const auto stored = ReadDatabaseImages(colmap.database());
  ColmapCameras cameras;
  std::vector<ColmapImage> images;
  for (size_t i = 0; i < views.size(); ++i) {
    const auto found = stored.find(plan[i].name);
    if (found == stored.end()) continue;  // colmap could not use this photograph and said so in its log
    const SceneView& view = scene.views[views[i]];
    cameras[found->second.camera_id] = view.lens;
    images.push_back({found->second.image_id, plan[i].name, found->second.camera_id, *view.cam_from_world});
  }
  SetDatabaseCameras(colmap.database(), cameras);
  WriteColmapText(dir, cameras, images);
  return images.size();
}

void Triangulate(const Scene& scene, const std::vector<int>& views, const std::vector<StagedView>& plan,
                 const fs::path& work_dir, const Listener& listener) {
  const ColmapRunner colmap(work_dir, listener);
  const bool has_masks = StageImages(scene, views, plan, work_dir);
  colmap.ExtractFeatures("SIMPLE_PINHOLE", has_masks);  // a placeholder: the true cameras follow
  if (WriteKnownPoses(scene, views, plan, colmap, work_dir / "poses") < 2) {
    throw ColmapFailure{"feature_extractor", 0, "fewer than two photographs could be used"};
  }
  colmap.MatchExhaustively();
  const fs::path made = work_dir / "models" / "0";
  MakeFolder(made);
  colmap.Run("point_triangulator",
             {{"image_path", colmap.images().string()},
              {"input_path", (work_dir / "poses").string()},
              {"output_path", made.string()},
              {"clear_points", "1"},
              {"Mapper.tri_ignore_two_view_tracks", "0"},  // few photographs: most points are seen twice only
              {"Mapper.ba_refine_focal_length", "0"},
              {"Mapper.ba_refine_principal_point", "0"},
              {"Mapper.ba_refine_extra_params", "0"},
              {"Mapper.fix_existing_images", "1"}},
             "triangulating");
  MoveFolder(made, work_dir / "sparse" / "0");
}

/// The mapper's options: as colmap has them, or for photographs that barely overlap.
ColmapOptions MapperOptions(bool relaxed) {
  ColmapOptions options{{"Mapper.min_model_size", "2"}, {"Mapper.tri_ignore_two_view_tracks", "0"}};
  if (relaxed) {
    options.insert({{"Mapper.min_num_matches", "10"},
                    {"Mapper.init_min_num_inliers", "50"},
                    {"Mapper.init_min_tri_angle", "4"},
                    {"Mapper.abs_pose_min_num_inliers", "15"},
                    {"Mapper.abs_pose_min_inlier_ratio", "0.15"}});
  }
  return options;
}

/// The model with the most photographs below `dir`; count 0 when there is none.
struct BestModel {
  fs::path dir;
  size_t count = 0;
};

BestModel FindBestModel(const fs::path& dir) {
  BestModel best;
  for (int i = 0; IsColmapModel(dir / std::to_string(i)); ++i) {
    const fs::path model = dir / std::to_string(i);
    const size_t count = ReadColmapImages(model).size();
    if (count > best.count) best = {model, count};
  }
  return best;
}

/// Runs the mapper, a second time with relaxed thresholds when the first leaves most photographs out.
size_t Map(const ColmapRunner& colmap, size_t photos, const fs::path& work_dir) {
  BestModel best;
  for (const bool relaxed : {false, true}) {
    const fs::path models = work_dir / "models" / (relaxed ? "relaxed" : "strict");
    MakeFolder(models);
    ColmapOptions options = MapperOptions(relaxed);
    options["image_path"] = colmap.images().string();
    options["output_path"] = models.string();
    try {
      colmap.Run("mapper", options, relaxed ? "registering, second try" : "registering");
    } catch (const ColmapFailure&) {
      // It also ends with an error when it finds no pair to start from.
    }
    const BestModel made = FindBestModel(models);
    if (made.count > best.count) best = made;
    if (best.count >= 2 && 2 * best.count >= photos) break;
  }
  if (best.count >= 2) MoveFolder(best.dir, work_dir / "sparse" / "0");
  std::error_code error;
  fs::remove_all(work_dir / "models", error);
  return best.count;
}

[[noreturn]] void FailRegistration(const Scene& photos, const fs::path& work_dir, const std::string& reason) {
  std::vector<std::string> names;
  for (const SceneView& view : photos.views) names.push_back(view.name);
  throw InputError(
      "{}: the cameras of its {} photographs could not be found ({}): {}. Take them again with more overlap between "
      "neighbours and sharp, textured surfaces, or give poses (transforms.json or a COLMAP model); see {}",
      photos.root.string(), names.size(), reason, JoinNames(names), (work_dir / "colmap.log").string());
}

void Register(const Scene& photos, const std::vector<StagedView>& plan, const fs::path& work_dir,
              const Listener& listener) {
  const ColmapRunner colmap(work_dir, listener);
  try {
    const bool has_masks = StageImages(photos, AllViews(photos), plan, work_dir);
    colmap.ExtractFeatures("SIMPLE_RADIAL", has_masks);
    colmap.MatchExhaustively();
  } catch (const ColmapFailure& failure) {
    throw RunError("colmap {} ended with code {}: {}; see {}", failure.command, failure.exit_code, failure.last_line,
                   (work_dir / "colmap.log").string());
  }
  if (Map(colmap, photos.views.size(), work_dir) < 2) {
    FailRegistration(photos, work_dir, "fewer than two photographs fit together");
  }
}

void TellRegistered(const Scene& photos, const std::map<int, SceneView>& registered, const Listener& listener) {
  std::vector<std::string> missing;
  for (int v = 0; v < static_cast<int>(photos.views.size()); ++v) {
    if (registered.count(v) == 0) missing.push_back(photos.views[v].name);
  }
  const std::string text = fmt::format("registered {} of {} photographs", registered.size(), photos.views.size());
  if (missing.empty()) {
    listener(Note{text});
  } else {
    listener(Warning{fmt::format("{}; not registered: {}", text, JoinNames(missing))});
  }
}

}  // namespace

bool ColmapAvailable() { return !FindProgram("colmap").empty(); }

Scene RegisterPhotos(const Scene& photos, const fs::path& work_dir, const Listener& listener) {
  const std::vector<int> views = AllViews(photos);
  const nlohmann::json inputs = DescribeInputs(photos, views);
  const std::vector<StagedView> plan = PlanStaging(photos, views);
  if (!IsUnchanged(work_dir, inputs)) {
    if (!ColmapAvailable()) {
      throw InputError(
          "{}: has photographs without poses, and the colmap program that finds them is not installed; install it "
          "(Debian: apt install colmap) or give a scene with poses",
          photos.root.string());
    }
    ClearWorkDir(work_dir);
    Register(photos, plan, work_dir, listener);
    WriteFileAtomically(work_dir / kInputs, inputs.dump(1) + "\n");
  }
  ModelInScene model = ReadModel(photos, views, plan, work_dir, listener);
  TellRegistered(photos, model.views, listener);
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

std::vector<ScenePoint> TriangulatePoints(const Scene& scene, const std::vector<int>& views, const fs::path& work_dir,
                                          const Listener& listener) {
  const nlohmann::json inputs = DescribeInputs(scene, views);
  const std::vector<StagedView> plan = PlanStaging(scene, views);
  if (IsUnchanged(work_dir, inputs)) {
    try {
      return ReadModel(scene, views, plan, work_dir, Silent()).points;
    } catch (const InputError& damage) {
      listener(Warning{fmt::format("{}; the points are triangulated again", damage.what())});
    }
  }
  if (!ColmapAvailable()) {
    listener(Warning{"the colmap program is not installed (Debian: apt install colmap): no points are triangulated"});
    return {};
  }
  ClearWorkDir(work_dir);
  try {
    Triangulate(scene, views, plan, work_dir, listener);
  } catch (const ColmapFailure& failure) {
    listener(
        Warning{fmt::format("colmap {} ended with code {}: {}; no points are triangulated, see {}", failure.command,
                            failure.exit_code, failure.last_line, (work_dir / "colmap.log").string())});
    return {};
  }
  std::vector<ScenePoint> points = ReadModel(scene, views, plan, work_dir, listener).points;
  WriteFileAtomically(work_dir / "points.ply", PointsPly(points));
  WriteFileAtomically(work_dir / kInputs, inputs.dump(1) + "\n");
  std::error_code ignored;
  for (const char* name : {"poses", "models"}) fs::remove_all(work_dir / name, ignored);
  listener(Note{fmt::format("triangulated {} points from {} photographs", points.size(), views.size())});
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
