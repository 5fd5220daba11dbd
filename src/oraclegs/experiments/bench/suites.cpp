#include "oraclegs/experiments/bench/suites.h"

#include <algorithm>
#include <iterator>
#include <set>

#include "oraclegs/core/text.h"
#include "oraclegs/image/read_image.h"

namespace oraclegs {
namespace {

namespace fs = std::filesystem;

/// Options that decide which pixels train and test.
constexpr const char* kProtocolOptions[] = {"eval",       "test-every", "view-steps", "train-views",
                                            "test-views", "max-size",   "downscale",  "smaller-copies",
                                            "resize",     "background", "images"};

// The 8 training views and the 25 of 200 test views of [Jain 2021].
constexpr const char* kBlenderTrain =
    "train/r_26,train/r_86,train/r_2,train/r_55,train/r_75,train/r_93,train/r_16,train/r_73";

std::string BlenderTest() {
  std::string list;
  for (int i = 0; i < 200; i += 8) list += fmt::format("{}test/r_{}", i == 0 ? "" : ",", i);
  return list;
}

// Positions of the images of a scan of 49 [Niemeyer 2022]; the first 3, 6 or 9 train.
constexpr int kDtuTrain[] = {25, 22, 28, 40, 44, 48, 0, 8, 13};
constexpr int kDtuTest[] = {1,  2,  9,  10, 11, 12, 14, 15, 23, 24, 26, 27, 29,
                            30, 31, 32, 33, 34, 35, 41, 42, 43, 45, 46, 47};

template <class Positions>
std::string PositionList(const Positions& positions, size_t count) {
  std::string list;
  for (size_t i = 0; i < count; ++i) list += fmt::format("{}:{}", i == 0 ? "" : ",", positions[i]);
  return list;
}

RunArguments MipNerf360(int views) {
  return {{"views", std::to_string(views)}, {"test-every", "8"},     {"downscale", "4"},
          {"smaller-copies", "required"},   {"background", "black"}, {"resize", "pillow"}};
}

RunArguments Blender(int) {
  return {{"train-views", kBlenderTrain},
          {"test-views", BlenderTest()},
          {"background", "white"},
          {"downscale", "2"},
          {"resize", "pillow"}};
}

RunArguments Llff(int views) {
  return {{"views", std::to_string(views)}, {"view-steps", "round"}, {"test-every", "8"}, {"downscale", "8"}};
}

RunArguments Dtu(int views) {
  return {{"train-views", PositionList(kDtuTrain, static_cast<size_t>(views))},
          {"test-views", PositionList(kDtuTest, std::size(kDtuTest))},
          {"downscale", "4"}};
}

/// Protocol of a folder of scenes. Blender scenes have test views of their own and ignore --test-every.
RunArguments OfFolder(int views) { return {{"views", std::to_string(views)}, {"test-every", "8"}}; }

std::vector<std::string> SuiteNames() {
  std::vector<std::string> names;
  for (const Suite& suite : Suites()) names.push_back(suite.name);
  return names;
}

bool LooksLikeScene(const fs::path& dir) {
  std::error_code ignored;
  for (const char* mark : {"sparse", "transforms.json", "transforms_train.json"}) {
    if (fs::exists(dir / mark, ignored)) return true;
  }
  for (const fs::path& photos : {dir, dir / "images"}) {
    for (const auto& entry : fs::directory_iterator(photos, ignored)) {
      if (HasImageExtension(entry.path())) return true;
    }
  }
  return false;
}

std::string NameOfFolder(const fs::path& folder) {
  std::error_code ignored;
  const fs::path path = fs::weakly_canonical(folder, ignored).lexically_normal();
  return (path.has_filename() ? path : path.parent_path()).filename().string();
}

std::vector<SuiteScene> ScenesBelow(const fs::path& folder) {
  if (LooksLikeScene(folder)) return {{NameOfFolder(folder), folder}};
  std::vector<SuiteScene> scenes;
  std::error_code ignored;
  for (const auto& entry : fs::directory_iterator(folder, ignored)) {
    const std::string name = entry.path().filename().string();
    if (name.starts_with('.') || !entry.is_directory(ignored) || !LooksLikeScene(entry.path())) continue;
    scenes.push_back({name, entry.path()});
  }
  std::sort(scenes.begin(), scenes.end(),
            [](const SuiteScene& a, const SuiteScene& b) { return NaturalLess(a.name, b.name); });
  if (scenes.empty()) {
    throw InputError("{}: neither it nor a folder in it is a scene; a scene has sparse/, transforms.json or photos",
                     folder.string());
  }
  return scenes;
}

}  // namespace

const std::vector<Suite>& Suites() {
  using enum SceneFormat;
  static const std::vector<Suite> suites = {
      // The seven scenes that sparse-view papers score; flowers and treehill came later than the rest.
      {.name = "mipnerf360",
       .label = "Mip-NeRF 360",
       .scenes = {"bicycle", "bonsai", "counter", "garden", "kitchen", "room", "stump"},
       .folders = {".", "mipnerf360", "mip_nerf_360", "360_v2"},
       .formats = {kColmap},
       .views = {12, 24},
       .other_views = true,
       .preset = "paper-mipnerf360-{}",
       .protocol = MipNerf360,
       .min_side = 700,
       .max_side = 1400},
      {.name = "blender",
       .label = "Blender (NeRF Synthetic)",
       .scenes = {"chair", "drums", "ficus", "hotdog", "lego", "materials", "mic", "ship"},
       .folders = {".", "blender", "nerf_synthetic"},
       .formats = {kBlender},
       .views = {8},
       .preset = "paper-blender-{}",
       .protocol = Blender,
       .min_side = 400,
       .max_side = 400},
      {.name = "llff",
       .label = "LLFF",
       .scenes = {"fern", "flower", "fortress", "horns", "leaves", "orchids", "room", "trex"},
       .folders = {".", "llff", "nerf_llff_data"},
       .formats = {kColmap},
       .views = {3, 6, 9},
       .other_views = true,
       .preset = "llff-{}",
       .protocol = Llff,
       .min_side = 504,
       .max_side = 504},
      {.name = "dtu",
       .label = "DTU",
       .scenes = {"scan8", "scan21", "scan30", "scan31", "scan34", "scan38", "scan40", "scan41", "scan45", "scan55",
                  "scan63", "scan82", "scan103", "scan110", "scan114"},
       .folders = {".", "dtu", "DTU"},
       .formats = {kColmap, kTransforms},
       .views = {3, 6, 9},
       .preset = "dtu-{}",
       .protocol = Dtu,
       .min_side = 400,
       .max_side = 400},
  };
  return suites;
}

Suite FindSuite(const std::string& word) {
  const std::vector<std::string> names = SuiteNames();
  if (word.empty()) throw UsageError("--suite is missing: {}, or a folder of scenes", fmt::join(names, ", "));
  const auto at = std::find(names.begin(), names.end(), word);
  if (at != names.end()) return Suites()[static_cast<size_t>(at - names.begin())];
  std::error_code ignored;
  if (!fs::is_directory(word, ignored)) {
    throw UsageError("--suite is '{}', which is neither {} nor a folder{}", word, fmt::join(names, ", "),
                     DidYouMean(word, names));
  }
  const std::string name = NameOfFolder(word);
  return {.name = name, .label = name, .views = {0}, .other_views = true, .protocol = OfFolder};
}

std::vector<SuiteScene> ScenesOf(const Suite& suite, const std::string& word, const fs::path& data) {
  if (suite.is_folder()) {
    if (!data.empty()) throw UsageError("--data goes with a named suite; --suite {} is itself the folder", word);
    return ScenesBelow(word);
  }
  if (data.empty()) throw UsageError("--data is missing: the folder with the scenes of {}", suite.label);
  std::error_code ignored;
  for (const std::string& folder : suite.folders) {
    const fs::path root = folder == "." ? data : data / folder;
    const auto is_there = [&](const std::string& scene) { return fs::exists(root / scene, ignored); };
    if (std::none_of(suite.scenes.begin(), suite.scenes.end(), is_there)) continue;
    std::vector<SuiteScene> scenes;
    for (const std::string& scene : suite.scenes) scenes.push_back({scene, root / scene});
    return scenes;
  }
  throw InputError("{}: holds no scene of {} (a folder {}, ...), neither itself nor in {}", data.string(), suite.label,
                   suite.scenes.front(),
                   fmt::join(std::vector<std::string>(suite.folders.begin() + 1, suite.folders.end()), ", "));
}

std::vector<int> ViewsOf(const Suite& suite, const std::string& list, const RunArguments& preset) {
  const std::string* of_preset = FindArgument(preset, "views");
  if (list.empty()) return of_preset ? ViewsOf(suite, *of_preset) : suite.views;
  std::set<int> views;
  for (const std::string& word : SplitTrimmed(list, ',')) {
    int number = 0;
    SetOption("views", word, &number);
    const bool is_published = std::find(suite.views.begin(), suite.views.end(), number) != suite.views.end();
    if (!is_published && !(suite.other_views && number >= 2)) {
      throw UsageError(
          "--views names {}; the protocol of {} has {}", number, suite.label,
          suite.is_folder() ? "0 (all) and numbers from 2 on" : fmt::format("{}", fmt::join(suite.views, ", ")));
    }
    if (of_preset && word != *of_preset) {
      throw UsageError("--views names {}, and the settings of --preset are for {}; name these alone, or another preset",
                       number, *of_preset);
    }
    views.insert(number);
  }
  if (views.empty()) throw UsageError("--views names none; {} has {}", suite.label, fmt::join(suite.views, ", "));
  return {views.begin(), views.end()};
}

std::string PaperPreset(const Suite& suite, int views) {
  if (!suite.preset.starts_with("paper-")) return "paper";
  if (std::find(suite.views.begin(), suite.views.end(), views) == suite.views.end()) {
    throw UsageError("the paper's settings for {} are of {} views, not of {}; leave these views or the paper out",
                     suite.label, fmt::join(suite.views, " and "), views);
  }
  return fmt::format(fmt::runtime(suite.preset), views);
}

bool IsOfProtocol(const std::string& option) {
  return option == "views" ||
         std::find(std::begin(kProtocolOptions), std::end(kProtocolOptions), option) != std::end(kProtocolOptions);
}

bool KeepsProtocol(const Suite& suite, const std::vector<int>& views, const RunArguments& asked) {
  return std::all_of(views.begin(), views.end(), [&](int count) {
    const RunArguments protocol = suite.protocol(count);
    return std::all_of(std::begin(kProtocolOptions), std::end(kProtocolOptions), [&](const char* name) {
      const std::string* value = FindArgument(asked, name);
      const std::string* fixed = FindArgument(protocol, name);
      return !value || (fixed && *fixed == *value);
    });
  });
}

void RequireOneList(const Suite& suite, const std::vector<int>& views, const RunArguments& asked) {
  if (views.size() < 2 || !FindArgument(asked, "train-views")) return;
  const RunArguments protocol = suite.protocol(views.front());
  if (FindArgument(protocol, "views")) return;  // the protocol picks that many of the list
  throw UsageError(
      "--train-views (a --preset may set it) fixes the images that train, so runs of {} views would be the same; name "
      "one number with --views, or leave the list or the preset out",
      fmt::join(views, ", "));
}

}  // namespace oraclegs
