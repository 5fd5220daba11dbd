#include "oraclegs/experiments/bench/scene_check.h"

#include <algorithm>

#include "oraclegs/core/text.h"
#include "oraclegs/datasets/read_scene.h"
#include "oraclegs/scene/loaded_view.h"
#include "oraclegs/scene/split.h"
#include "oraclegs/settings/weights.h"

namespace oraclegs {
namespace {

void RequireLayout(const Suite& suite, const Scene& scene) {
  const auto& formats = suite.formats;
  if (formats.empty() || std::find(formats.begin(), formats.end(), scene.format) != formats.end()) return;
  throw InputError("{}: holds {}; {} comes as {}", scene.root.string(), SceneFormatName(scene.format), suite.label,
                   SceneFormatName(formats.front()));
}

void RequireAllImages(const Suite& suite, const Scene& scene) {
  if (suite.is_folder() || scene.missing_images.empty()) return;
  throw InputError("{}: {} named by its cameras {} missing ({}); the split counts all of them", scene.root.string(),
                   Counted(scene.missing_images.size(), "image"), scene.missing_images.size() == 1 ? "is" : "are",
                   SomeNames(scene.missing_images));
}

void RequireSize(const Suite& suite, const SceneCheck& check) {
  const int side = std::max(check.width, check.height);
  if (suite.max_side == 0 || (side >= suite.min_side && side <= suite.max_side)) return;
  throw InputError(
      "{}: its images are scored at {}x{}; those of {} are {} pixels wide then: take the dataset's full-size photos",
      check.scene.path.string(), check.width, check.height, suite.label,
      suite.min_side == suite.max_side ? fmt::format("{}", suite.min_side)
                                       : fmt::format("{} to {}", suite.min_side, suite.max_side));
}

/// Throws InputError where smaller copies of images are missing. The run would find that only hours later.
void RequireCopies(const Scene& scene, const std::vector<int>& views, const ImageOptions& options) {
  if (options.smaller_copies != SmallerCopies::kRequired || options.downscale == 1) return;
  for (const int i : views) {
    const SceneView& view = scene.views[static_cast<size_t>(i)];
    if (ImageFile(view, options) != view.image_path) continue;
    throw InputError("{}: has no copy of {} of that size in images_{}; scores compare only with the dataset's own",
                     scene.root.string(), view.name, options.downscale);
  }
}

/// Fills in the images and the size that the protocol uses. Throws InputError.
void Take(const Suite& suite, const Scene& scene, const RunArguments& asked, SceneCheck* check) {
  const RunOptions options = OptionsOf(Overlaid(suite.protocol(check->views), asked));
  const Split split = SplitViews(scene, WithListsRead(options.split));
  check->train = NamesAt(scene, split.train), check->test = NamesAt(scene, split.test);
  if (!scene.HasPoses()) return;
  std::vector<int> both = split.train;
  both.insert(both.end(), split.test.begin(), split.test.end());
  RequireCopies(scene, both, options.image.Settled());
  const Camera camera = WorkingCamera(scene.views[static_cast<size_t>(split.train.front())], options.image.Settled());
  check->width = camera.width, check->height = camera.height;
  if (KeepsProtocol(suite, {check->views}, asked)) RequireSize(suite, *check);
}

std::string Names(const std::vector<std::string>& names) {
  return names.empty() ? "" : fmt::format(" ({})", SomeNames(names));
}

}  // namespace

std::vector<SceneCheck> CheckScene(const Suite& suite, const SuiteScene& scene, const std::vector<int>& views,
                                   const RunArguments& asked) {
  std::vector<SceneCheck> checks;
  std::string of_all;
  Scene read;
  try {
    std::error_code ignored;
    if (!std::filesystem::exists(scene.path, ignored)) throw InputError("{}: is missing", scene.path.string());
    const RunOptions options = OptionsOf(asked);
    read = ReadScene(scene.path, {options.input.images, options.input.allow_outside}, Silent());
    RequireLayout(suite, read);
    RequireAllImages(suite, read);
  } catch (const InputError& error) {
    of_all = error.what();
  }
  for (const int count : views) {
    SceneCheck check{.scene = scene, .views = count, .problem = of_all};
    try {
      if (of_all.empty()) Take(suite, read, asked, &check);
    } catch (const InputError& error) {
      check.problem = error.what();
    }
    checks.push_back(std::move(check));
  }
  return checks;
}

std::string CheckText(const std::vector<SceneCheck>& checks) {
  std::string text;
  for (const SceneCheck& check : checks) {
    const std::string name =
        check.views > 0 ? fmt::format("{}, {} views", check.scene.name, check.views) : check.scene.name;
    if (!check.problem.empty()) {
      text += fmt::format("{}: cannot be run: {}\n", name, check.problem);
      continue;
    }
    const std::string size = check.width > 0 ? fmt::format("{}x{} pixels", check.width, check.height)
                                             : "poses and size are found when it runs";
    text += fmt::format("{}: {}{}, {}{}, {}\n", name, Counted(check.train.size(), "training image"), Names(check.train),
                        Counted(check.test.size(), "test image"), Names(check.test), size);
  }
  return text;
}

std::string LpipsText(const RunArguments& asked) {
  const auto files = FindLpips(OptionsOf(asked).weights);
  const std::string protocol = fmt::format("LPIPS by {} of images in [0, 1]", kSuiteLpips);
  if (files.empty())
    return fmt::format("{}: not measured, its weights are missing; {}", protocol, HowToFetch(kLpipsModel));
  return fmt::format("{}, with {}", protocol, files.front().string());
}

}  // namespace oraclegs
