#pragma once
// Datasets with the protocols that papers score them by, and folders of the user's own scenes.

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
  std::vector<std::string> folders = {};  ///< subfolders of --data in which these may lie
  std::vector<SceneFormat> formats = {};  ///< formats of the dataset; empty = any
  std::vector<int> views;                 ///< numbers of training views that papers report
  bool other_views = false;               ///< true when the protocol defines other numbers of views, too
  std::string preset = {};  ///< preset with the same images, of each of `views`, which stands for {}; "" = none
  /// Options that the protocol fixes: images, their size, background. `views` 0 = all but the test views.
  RunArguments (*protocol)(int views) = nullptr;
  int min_side = 0, max_side = 0;  ///< longer side of the images as scored, pixels; 0 = any

  bool is_folder() const { return scenes.empty(); }
};

inline constexpr const char* kSuiteLpips = "VGG16";  ///< the network of LPIPS in the papers of all these suites

/// The named suites.
const std::vector<Suite>& Suites();

/// Suite of this name, or that of a folder. Throws UsageError that lists the names, with the nearest word.
Suite FindSuite(const std::string& word);

/// All scenes of a named suite in its order, whether they exist or not; for a folder, the folder itself where it looks
/// like a scene, else those subfolders that do. Throws UsageError when `data` is missing for a named suite or given for
/// a folder, InputError when there is no scene at all.
std::vector<SuiteScene> ScenesOf(const Suite& suite, const std::string& word, const std::filesystem::path& data);

/// Numbers that --views lists, ascending, each once; for "" that of the preset, else the suite's own. Throws UsageError
/// for text that is no number, and for numbers that the protocol does not define or that are not the preset's.
std::vector<int> ViewsOf(const Suite& suite, const std::string& list, const RunArguments& preset = {});

/// Name of the preset with the OracleGS paper's settings: the suite's own for this number of views, else "paper", which
/// is that of scenes of no dataset. Throws UsageError for a number of views that the suite's presets do not have.
std::string PaperPreset(const Suite& suite, int views);

/// True for an option that decides which pixels train and test: it is the same for all methods.
bool IsOfProtocol(const std::string& option);

/// True when the user's options keep the protocol for each of these numbers of views: the same images in the same size.
bool KeepsProtocol(const Suite& suite, const std::vector<int>& views, const RunArguments& asked);

/// Throws UsageError where the user's list of training images replaces those that the protocol names for several
/// numbers of views: all of these would train on the same images.
void RequireOneList(const Suite& suite, const std::vector<int>& views, const RunArguments& asked);

}  // namespace oraclegs
