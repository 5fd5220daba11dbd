#include "oraclegs/scene/split.h"

#include <algorithm>
#include <filesystem>
#include <nlohmann/json.hpp>

#include "oraclegs/core/error.h"
#include "oraclegs/core/text.h"
#include "oraclegs/scene/scene.h"

namespace oraclegs {
namespace {

/// The ways to call a view, most exact first.
std::vector<std::string> NamesOf(const std::string& name) {
  const std::filesystem::path path(name);
  std::filesystem::path without_extension = path;
  without_extension.replace_extension();
  return {name, path.filename().string(), without_extension.string(), path.stem().string()};
}

std::vector<std::string> NamesAt(const Scene& scene, const std::vector<int>& views) {
  std::vector<std::string> names;
  for (const int i : views) names.push_back(scene.views[static_cast<size_t>(i)].name);
  return names;
}

/// The one view that `wanted` calls; the most exact way to call it that fits anything decides.
int FindView(const Scene& scene, const std::string& wanted) {
  const size_t ways = NamesOf("").size();
  for (size_t way = 0; way < ways; ++way) {
    std::vector<int> found;
    for (const int i : AllViews(scene)) {
      if (NamesOf(scene.views[static_cast<size_t>(i)].name)[way] == wanted) found.push_back(i);
    }
    if (found.size() == 1) return found.front();
    if (found.size() > 1) {
      throw InputError("{}: the test view '{}' could be any of {}; give its full name", scene.root.string(), wanted,
                       SomeNames(NamesAt(scene, found)));
    }
  }
  const auto missing = std::find_if(scene.missing_images.begin(), scene.missing_images.end(), [&](const auto& name) {
    const auto names = NamesOf(name);
    return std::find(names.begin(), names.end(), wanted) != names.end();
  });
  if (missing != scene.missing_images.end()) {
    throw InputError("{}: the test view '{}' has no image file", scene.root.string(), wanted);
  }
  throw InputError("{}: no view is called '{}'; there are {}", scene.root.string(), wanted,
                   SomeNames(NamesAt(scene, AllViews(scene))));
}

std::vector<int> NamedViews(const Scene& scene, const std::string& list) {
  std::vector<int> named;
  for (const std::string& word : SplitAtCommas(list)) named.push_back(FindView(scene, word));
  std::sort(named.begin(), named.end());
  named.erase(std::unique(named.begin(), named.end()), named.end());
  return named;
}

std::vector<int> EveryNth(const Scene& scene, int n) {
  std::vector<int> views;
  for (size_t i = 0; n > 0 && i < scene.views.size(); i += static_cast<size_t>(n)) views.push_back(static_cast<int>(i));
  return views;
}

std::vector<int> ViewsOfRole(const Scene& scene, DeclaredRole role) {
  std::vector<int> views = AllViews(scene);
  std::erase_if(views, [&](int i) { return scene.views[static_cast<size_t>(i)].role != role; });
  return views;
}

/// candidates[linspace(0, n-1, count)], truncated. The products are numpy's (i * step, the last exact), so that the
/// same views are picked where the ideal value is a whole number and rounding decides.
std::vector<int> PickEvenly(const std::vector<int>& candidates, int count) {
  const double last = static_cast<double>(candidates.size() - 1);
  const double step = count > 1 ? last / (count - 1) : 0;
  std::vector<int> picked;
  for (int i = 0; i < count; ++i) {
    const double place = i > 0 && i == count - 1 ? last : i * step;
    picked.push_back(candidates[static_cast<size_t>(place)]);
  }
  return picked;
}

}  // namespace

Split SplitViews(const Scene& scene, const SplitOptions& options) {
  const bool blender = scene.format == SceneFormat::kBlender;
  Split split;
  if (!options.test_views.empty()) {
    split.test = NamedViews(scene, options.test_views);
  } else if (blender) {
    split.test = ViewsOfRole(scene, DeclaredRole::kTest);
  } else {
    split.test = EveryNth(scene, options.test_every);
  }
  const std::vector<int> candidates = blender ? ViewsOfRole(scene, DeclaredRole::kTrain) : AllViews(scene);
  std::set_difference(candidates.begin(), candidates.end(), split.test.begin(), split.test.end(),
                      std::back_inserter(split.train));
  const size_t available = split.train.size();
  if (options.views > 0 && static_cast<size_t>(options.views) > available) {
    throw InputError("{}: --views asks for {} training views, but only {} are left beside {} test views; ask for fewer",
                     scene.root.string(), options.views, available, split.test.size());
  }
  if (options.views > 0) split.train = PickEvenly(split.train, options.views);
  if (split.train.size() < 2) {
    throw InputError(
        "{}: {} training view(s) out of {} photos, {} of them test views; training needs 2 or more, "
        "see --views and --test-every",
        scene.root.string(), split.train.size(), scene.views.size(), split.test.size());
  }
  return split;
}

nlohmann::json SplitToJson(const Scene& scene, const Split& split) {
  return {{"train", NamesAt(scene, split.train)}, {"test", NamesAt(scene, split.test)}};
}

}  // namespace oraclegs
