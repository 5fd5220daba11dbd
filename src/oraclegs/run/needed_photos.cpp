#include "oraclegs/run/needed_photos.h"

#include <set>

#include "oraclegs/core/error.h"
#include "oraclegs/core/text.h"
#include "oraclegs/sfm/choose_pairs.h"

namespace oraclegs {

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

}  // namespace oraclegs
