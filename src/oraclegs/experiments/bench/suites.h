#pragma once
// Datasets with the protocol that papers score them by, and folders of the user's own scenes.

#include <filesystem>
#include <string>
#include <vector>

#include "oraclegs/experiments/bench/run_arguments.h"
#include "oraclegs/scene/scene.h"

namespace oraclegs {

struct SuiteScene {
  std::string name;
  std::filesystem::path path;
};

struct Suite {
  std::string name;                       ///< for --suite and folders
  std::string label;                      ///< for tables
  std::vector<std::string> scenes = {};   ///< names of their folders
  std::vector<std::string> folders = {};  ///< below --data, where these may lie
  std::vector<SceneFormat> formats = {};  ///< that the dataset comes in; empty = any
  std::vector<int> views;                 ///< numbers of training views that papers report
  bool other_views = false;               ///< the protocol says what others are, too
  std::string preset = {};                ///< with the same images; {} = the number of views; "" = none
  /// What the protocol fixes: images, their size, background. `views` 0 = all that are not test views.
  RunArguments (*protocol)(int views) = nullptr;
  int min_side = 0, max_side = 0;  ///< of the longer side of the images as they are scored, pixels; 0 = any

  bool is_folder() const { return scenes.empty(); }
};

inline constexpr const char* kSuiteLpips = "VGG16";  ///< the network of LPIPS in the papers of all these suites

/// The named ones.
const std::vector<Suite>& Suites();

/// The suite of this name, or that of a folder. Throws UsageError that lists the names, with the nearest word.
Suite FindSuite(const std::string& word);

/// All scenes of a suite in its order, whether they are there or not; of a folder what ReadScene may be able to read:
/// the folder itself, where it looks like a scene, else those of its subfolders that do. Throws UsageError when `data`
/// is missing for a named suite or given for a folder, InputError when there is no scene at all.
std::vector<SuiteScene> ScenesOf(const Suite& suite, const std::string& word, const std::filesystem::path& data);

/// The numbers that --views lists, ascending, each once; the suite's own for "". Throws UsageError for what is no
/// number, and for one that the protocol does not say.
std::vector<int> ViewsOf(const Suite& suite, const std::string& list);

/// Whether runs with these options of the user's still see what the protocol says of each of these numbers of views:
/// the same images in the same size.
bool KeepsProtocol(const Suite& suite, const std::vector<int>& views, const RunArguments& asked);

/// Throws UsageError where a list of training images of the user's would take the place of those that the protocol
/// names for several numbers of views, which would all train on the same.
void RequireOneList(const Suite& suite, const std::vector<int>& views, const RunArguments& asked);

}  // namespace oraclegs
