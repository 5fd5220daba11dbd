#include <fmt/format.h>

#include <map>
#include <string>
#include <system_error>
#include <vector>

#include "oraclegs/core/error.h"
#include "oraclegs/scene/colmap_model.h"
#include "oraclegs/scene/colmap_runner.h"
#include "oraclegs/scene/colmap_staging.h"
#include "oraclegs/scene/sfm.h"
#include "oraclegs/scene/sfm_workspace.h"

namespace oraclegs {
namespace {

namespace fs = std::filesystem;

constexpr size_t kNamesInMessage = 12;

std::vector<int> AllViews(const Scene& scene) {
  std::vector<int> views(scene.views.size());
  for (size_t i = 0; i < views.size(); ++i) views[i] = static_cast<int>(i);
  return views;
}

std::string JoinNames(std::vector<std::string> names) {
  const size_t more = names.size() > kNamesInMessage ? names.size() - kNamesInMessage : 0;
  names.resize(names.size() - more);
  return fmt::format("{}{}", fmt::join(names, ", "), more > 0 ? fmt::format(" and {} more", more) : "");
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

Scene RegisterPhotos(const Scene& photos, const fs::path& work_dir, const Listener& listener) {
  const std::vector<int> views = AllViews(photos);
  const nlohmann::json inputs = DescribeInputs(photos, views);
  const std::vector<StagedView> plan = PlanStaging(photos, views);
  if (IsUnchanged(work_dir, inputs)) {
    RestoreImages(photos, views, plan, work_dir);
  } else {
    if (!ColmapAvailable()) {
      throw InputError(
          "{}: has photographs without poses, and the colmap program that finds them is not installed; install it "
          "(Debian: apt install colmap) or give a scene with poses",
          photos.root.string());
    }
    ClearWorkDir(work_dir);
    Register(photos, plan, work_dir, listener);
    MarkDone(work_dir, inputs);
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

}  // namespace oraclegs
