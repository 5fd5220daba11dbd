#include "oraclegs/sfm/match_for_check.h"

#include <fmt/format.h>

#include <algorithm>
#include <map>
#include <nlohmann/json.hpp>
#include <set>

#include "oraclegs/sfm/colmap_database.h"
#include "oraclegs/sfm/colmap_runner.h"
#include "oraclegs/sfm/colmap_staging.h"
#include "oraclegs/sfm/colmap_workspace.h"

namespace oraclegs {
namespace {

namespace fs = std::filesystem;

constexpr size_t kNeighbors = 3;
constexpr int kCheckImageSide = 800, kCheckFeatures = 1500;

void Match(const Scene& scene, const std::vector<int>& views, const std::vector<StagedView>& plan,
           const ColmapRunner& colmap, bool has_masks) {
  colmap.ExtractFeatures("SIMPLE_PINHOLE", has_masks,
                         {{"SiftExtraction.max_image_size", std::to_string(kCheckImageSide)},
                          {"SiftExtraction.max_num_features", std::to_string(kCheckFeatures)}});
  std::map<uint32_t, Intrinsics> cameras;
  const auto stored = ReadDatabaseImages(colmap.database());
  for (size_t i = 0; i < views.size(); ++i) {
    const auto found = stored.find(plan[i].name);
    if (found != stored.end()) cameras[found->second.camera_id] = scene.views[static_cast<size_t>(views[i])].intrinsics;
  }
  SetDatabaseCameras(colmap.database(), cameras);
  std::vector<std::pair<std::string, std::string>> names;
  for (const auto& [a, b] : NeighborsByPoints(scene, views))
    names.emplace_back(plan[static_cast<size_t>(a)].name, plan[static_cast<size_t>(b)].name);
  colmap.MatchPairs(names, {}, "matching");
}

}  // namespace

std::vector<std::pair<int, int>> NeighborsByPoints(const Scene& scene, const std::vector<int>& views) {
  std::map<int, int> position;
  for (size_t i = 0; i < views.size(); ++i) position[views[i]] = static_cast<int>(i);
  const size_t n = views.size();
  std::vector<std::vector<int>> common(n, std::vector<int>(n, 0));
  for (const ScenePoint& point : scene.points) {
    std::vector<size_t> seen;
    for (const int view : point.views) {
      if (const auto found = position.find(view); found != position.end())
        seen.push_back(static_cast<size_t>(found->second));
    }
    for (const size_t a : seen) {
      for (const size_t b : seen) common[a][b] += a != b;
    }
  }
  std::set<std::pair<int, int>> pairs;
  for (size_t a = 0; a < n; ++a) {
    std::vector<int> others;
    for (size_t b = 0; b < n; ++b) {
      if (common[a][b] > 0) others.push_back(static_cast<int>(b));
    }
    std::stable_sort(others.begin(), others.end(), [&](int x, int y) {
      return common[a][static_cast<size_t>(x)] > common[a][static_cast<size_t>(y)];
    });
    if (others.size() > kNeighbors) others.resize(kNeighbors);
    for (const int b : others) pairs.insert(std::minmax(static_cast<int>(a), b));
  }
  return {pairs.begin(), pairs.end()};
}

void MatchForCheck(const Scene& scene, const std::vector<int>& views, const fs::path& work_dir,
                   const Listener& listener) {
  const nlohmann::json inputs = DescribeInputs(scene, views);
  if (IsUnchanged(work_dir, inputs)) return;
  if (!ColmapAvailable()) {
    listener(Note{"the given poses are not checked: the colmap program is not installed (Debian: apt install colmap)"});
    return;
  }
  ClearWorkDir(work_dir);
  const std::vector<StagedView> plan = PlanStaging(scene, views);
  try {
    MakeFolder(AttemptsFolder(work_dir));
    const bool has_masks = StageImages(scene, views, plan, work_dir);
    Match(scene, views, plan, ColmapRunner(work_dir, listener, "sfm"), has_masks);
  } catch (const ColmapFailure& failure) {
    listener(Note{fmt::format("the given poses are not checked: {}; see {}", failure.Text(),
                              (work_dir / "colmap.log").string())});
    return;
  }
  MarkDone(work_dir, inputs);
  RemoveAttempts(work_dir);
}

}  // namespace oraclegs
