#include "oraclegs/scene/split.h"

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>

#include "oraclegs/core/error.h"
#include "oraclegs/core/text.h"
#include "oraclegs/scene/spheres.h"
#include "oraclegs/scene/view_list.h"

namespace oraclegs {
namespace {

constexpr int kUsualTestEvery = 8;  // of the sparse-view papers

using Photos = std::vector<std::vector<int>>;  // the views of each

std::vector<int> ViewsOf(const Photos& photos) {
  std::vector<int> views;
  for (const std::vector<int>& photo : photos) views.insert(views.end(), photo.begin(), photo.end());
  std::sort(views.begin(), views.end());
  return views;
}

std::vector<int> EveryNth(const Scene& scene, int n) {
  const Photos photos = ByPhoto(scene, AllViews(scene));
  Photos picked;
  for (size_t i = 0; n > 0 && i < photos.size(); i += static_cast<size_t>(n)) picked.push_back(photos[i]);
  return ViewsOf(picked);
}

/// Whoever names a face means its sphere: the others show what is beside it, from the same place.
std::vector<int> WithOtherFaces(const Scene& scene, const std::vector<int>& named) {
  Photos photos = ByPhoto(scene, AllViews(scene));
  std::erase_if(photos, [&](const std::vector<int>& photo) {
    return std::none_of(photo.begin(), photo.end(),
                        [&](int v) { return std::binary_search(named.begin(), named.end(), v); });
  });
  return ViewsOf(photos);
}

std::vector<int> Named(const Scene& scene, const char* option, const std::string& list) {
  return WithOtherFaces(scene, NamedViews(scene, option, list));
}

std::vector<int> ViewsOfRole(const Scene& scene, DeclaredRole role) {
  std::vector<int> views = AllViews(scene);
  std::erase_if(views, [&](int i) { return scene.views[static_cast<size_t>(i)].role != role; });
  return views;
}

/// The views of photos[linspace(0, n-1, count)], truncated or rounded. The products are numpy's (i * step, the last
/// exact), so that the same views are picked where the ideal value is a whole number and its last bits decide.
std::vector<int> PickEvenly(const Photos& photos, int count, ViewSteps steps) {
  const double last = static_cast<double>(photos.size() - 1);
  const double step = count > 1 ? last / (count - 1) : 0;
  Photos picked;
  for (int i = 0; i < count; ++i) {
    const double place = i > 0 && i == count - 1 ? last : i * step;
    picked.push_back(photos[static_cast<size_t>(steps == ViewSteps::kRound ? std::nearbyint(place) : place)]);
  }
  return ViewsOf(picked);
}

std::vector<int> Without(const std::vector<int>& views, const std::vector<int>& others) {
  std::vector<int> left;
  std::set_difference(views.begin(), views.end(), others.begin(), others.end(), std::back_inserter(left));
  return left;
}

/// Whether the scene's own lists say which views train and test: always of a Blender scene, of others unless an option
/// says it.
bool SplitsItself(const Scene& scene, const SplitOptions& options) {
  if (scene.format == SceneFormat::kBlender) return true;
  const bool named = !options.train_views.empty() || !options.test_views.empty();
  if (named || options.eval || !options.test_every.is_auto()) return false;
  return std::any_of(scene.views.begin(), scene.views.end(), [](const SceneView& view) {
    return view.role == DeclaredRole::kTrain || view.role == DeclaredRole::kTest;
  });
}

/// The views of the scene's training list; without one, all that no other list has.
std::vector<int> DeclaredTrainingViews(const Scene& scene) {
  std::vector<int> views = ViewsOfRole(scene, DeclaredRole::kTrain);
  return views.empty() && scene.format != SceneFormat::kBlender ? ViewsOfRole(scene, DeclaredRole::kNone) : views;
}

std::vector<int> TestViewsOf(const Scene& scene, const SplitOptions& options) {
  if (!options.test_views.empty()) return Named(scene, "--test-views", options.test_views);
  if (SplitsItself(scene, options)) return ViewsOfRole(scene, DeclaredRole::kTest);
  return EveryNth(scene, options.test_every.ValueOr(options.eval ? kUsualTestEvery : 0));
}

void RequireApart(const Scene& scene, const std::vector<int>& train, const std::vector<int>& test) {
  std::vector<int> both;
  std::set_intersection(train.begin(), train.end(), test.begin(), test.end(), std::back_inserter(both));
  if (both.empty()) return;
  throw InputError("{}: both --train-views and --test-views name {}; a view that trains cannot test",
                   scene.root.string(), SomeNames(NamesAt(scene, both)));
}

}  // namespace

SplitOptions WithListsRead(const SplitOptions& options) {
  SplitOptions read = options;
  read.train_views = ExpandViewList(options.train_views, "train");
  read.test_views = ExpandViewList(options.test_views, "test");
  return read;
}

Split SplitViews(const Scene& scene, const SplitOptions& options) {
  Split split;
  split.test = TestViewsOf(scene, options);
  if (options.train_views.empty()) {
    split.train = Without(SplitsItself(scene, options) ? DeclaredTrainingViews(scene) : AllViews(scene), split.test);
  } else {
    split.train = Named(scene, "--train-views", options.train_views);
    if (!options.test_views.empty()) RequireApart(scene, split.train, split.test);
    split.test = Without(split.test, split.train);
  }
  const Photos photos = ByPhoto(scene, split.train);
  const size_t available = photos.size();
  if (options.views > 0 && static_cast<size_t>(options.views) > available) {
    throw InputError("{}: --views asks for {}, but only {} left beside {}; ask for fewer", scene.root.string(),
                     Counted(options.views, "training view"),
                     available == 1 ? "1 is" : fmt::format("{} are", available),
                     Counted(split.test.size(), "test view"));
  }
  if (options.views > 0) split.train = PickEvenly(photos, options.views, options.view_steps);
  if (ByPhoto(scene, AllViews(scene)).size() == 1) {
    throw InputError("{}: one photo is not enough; give 3 or more of the same things from different places",
                     scene.root.string());
  }
  if (split.train.size() < 2) {
    throw InputError(
        "{}: {} of {} for training beside {}; training needs 2 or more (3 or better), see --views, --train-views, "
        "--test-views and --eval",
        scene.root.string(), split.train.size(), Counted(scene.views.size(), "photo"),
        Counted(split.test.size(), "test view"));
  }
  return split;
}

nlohmann::json SplitToJson(const Scene& scene, const Split& split) {
  return {{"train", NamesAt(scene, split.train)}, {"test", NamesAt(scene, split.test)}};
}

}  // namespace oraclegs
