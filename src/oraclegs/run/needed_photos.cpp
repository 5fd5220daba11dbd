#include "oraclegs/run/needed_photos.h"

#include <algorithm>
#include <set>
#include <string>
#include <vector>

#include "oraclegs/capture/photo_checks.h"
#include "oraclegs/core/error.h"
#include "oraclegs/core/files.h"
#include "oraclegs/core/text.h"
#include "oraclegs/core/unique_json.h"
#include "oraclegs/scene/spheres.h"
#include "oraclegs/sfm/choose_pairs.h"

namespace oraclegs {
namespace {
namespace fs = std::filesystem;
using nlohmann::json;

constexpr uint64_t kMaxChecksBytes = 16 << 20;

/// Stored checks of these photos; null when there are none, or they are of other photos.
json KeptOf(const Run& run) {
  try {
    json kept = ParseJsonOrDiscard(ReadFile(run.workspace.photo_checks(), kMaxChecksBytes));
    if (kept.is_object() && kept.value("photos", json()) == run.photos) return kept;
  } catch (const Error&) {  // missing or damaged: the photos are checked again
  }
  return nullptr;
}

std::vector<std::string> TextsOf(const json& kept, const char* name) {
  std::vector<std::string> texts;
  const json list = kept.value(name, json::array());
  for (const json& text : list) {
    if (text.is_string()) texts.push_back(text.get<std::string>());
  }
  return texts;
}

json Look(const Run& run) {
  const std::vector<CheckedPhoto> photos = PhotosToCheck(run.scene);
  const PhotoTrouble trouble = CheckPhotos(photos, run.listener);
  std::vector<std::string> unreadable;
  for (const size_t i : trouble.unreadable) unreadable.push_back(photos[i].name);
  return {{"photos", run.photos}, {"warnings", trouble.warnings}, {"unreadable", unreadable}};
}

void LeaveOut(const std::vector<std::string>& names, Scene* scene) {
  std::erase_if(scene->views,
                [&](const SceneView& view) { return std::find(names.begin(), names.end(), view.name) != names.end(); });
}

}  // namespace

void KeepNeededPhotos(Run* run, const Listener& listener) {
  const auto photos = static_cast<int>(run->scene.views.size());
  const SplitOptions& options = run->options.split;
  if (run->photos.empty() || photos <= kMaxImagesToMatchAll || (options.views == 0 && options.train_views.empty())) {
    return;
  }
  const Split split = SplitViews(run->scene, options);
  run->needed = NeededViews{NamesAt(run->scene, split.train), NamesAt(run->scene, split.test)};
  std::set<std::string> names(run->needed->train.begin(), run->needed->train.end());
  names.insert(run->needed->test.begin(), run->needed->test.end());
  std::erase_if(run->scene.views, [&](const SceneView& view) { return names.count(view.name) == 0; });
  listener(Note{fmt::format("{} of {} are used (--views, --train-views): poses are found for these alone",
                            run->scene.views.size(), Counted(photos, "photo"))});
}

Split SplitOfRun(const Run& run) {
  if (!run.needed) return SplitViews(run.scene, run.options.split);
  const std::set<std::string> train(run.needed->train.begin(), run.needed->train.end());
  Split split;
  for (const int v : AllViews(run.scene)) {
    (train.count(run.scene.views[static_cast<size_t>(v)].name) > 0 ? split.train : split.test).push_back(v);
  }
  if (split.train.size() < 2) {
    throw InputError("{}: {} of its training photos found a pose; training needs 2 or more, see --views",
                     run.scene.root.string(), split.train.size());
  }
  return split;
}

void CheckRunPhotos(Run* run) {
  if (run->photos.empty()) return;
  json kept = KeptOf(*run);
  if (kept.is_null()) {
    kept = Look(*run);
    WriteFileAtomically(run->workspace.photo_checks(), kept.dump(1, ' ', false, json::error_handler_t::replace) + "\n");
  }
  for (const std::string& warning : TextsOf(kept, "warnings")) run->listener(Warning{warning});
  LeaveOut(TextsOf(kept, "unreadable"), &run->scene);
}

void LeaveOutUnreadablePhotos(Run* run) {
  if (run->photos.empty()) return;
  const json kept = KeptOf(*run);
  if (!kept.is_null()) LeaveOut(TextsOf(kept, "unreadable"), &run->scene);
}

}  // namespace oraclegs
