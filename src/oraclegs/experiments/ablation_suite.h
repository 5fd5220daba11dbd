#pragma once
// Ablations of several scenes, and their mean; of a suite's scenes at each of its numbers of views.

#include <functional>

#include "oraclegs/experiments/ablation.h"
#include "oraclegs/experiments/bench/scene_check.h"

namespace oraclegs {

/// Mean over scenes for each row and seed, so that deviations are those of the mean between seeds. It has the rows that
/// all scenes have; a seed that failed in one scene counts as failed. Notes are those of all scenes. `scenes` must not
/// be empty.
Ablation MeanOver(const std::vector<Ablation>& scenes);

/// The scene of the request and those of --also. Throws UsageError when two of them have one name.
std::vector<std::filesystem::path> ScenesOf(const AblationRequest& request);

/// Runs RunAblation for each of `scenes` in out/NAME, named after its folder. Rewrites the mean, out/ablation.json and
/// out/ablation.md, after each scene. Throws as RunAblation does.
Ablation RunScenes(const AblationRequest& request, const std::vector<std::filesystem::path>& scenes,
                   const Listener& listener);

/// Commands of these trainings (AblationCommands).
std::string SceneCommands(const AblationRequest& request, const std::vector<std::filesystem::path>& scenes);

/// Settings of the trainings of a suite beside its protocol.
struct SuiteSettings {
  RunArguments asked;  ///< as the user gave them
  std::string preset;  ///< "" = none; "paper" = the paper's of the suite and number of views (PaperPreset)
  std::function<RunArguments(const std::string& name)> read_preset;  ///< throws UsageError where there is none
};

/// Ablations of the scenes of a named suite.
struct SuiteAblation {
  struct OfViews {
    int views = 0;
    AblationRequest request;  ///< its folder is out/VIEWS-views
    std::vector<std::filesystem::path> scenes;
  };
  std::string label;               ///< of the suite, for people
  std::vector<OfViews> parts;      ///< in the order of the numbers of views
  std::vector<SceneCheck> checks;  ///< scene by scene, for each number of views; those with a problem have no part
};

/// Plan for request.options.suite, whose scenes lie in the folder request.run.scene or below it. Options of a training
/// are the suite's protocol, over it the preset's, over these the user's. Throws UsageError for an unknown suite, and
/// for views that the suite or the preset does not have; InputError when no scene can be run.
SuiteAblation PlanSuiteAblation(const AblationRequest& request, const SuiteSettings& settings);

/// Images, sizes, and the command of each training, for --dry-run.
std::string SuiteAblationText(const SuiteAblation& suite);

/// Runs RunScenes for each number of views, and returns the means. Rewrites the table of all of them side by side,
/// out/ablation.md, and out/ablation.json after each.
std::vector<Ablation> RunSuiteAblation(const AblationRequest& request, const SuiteAblation& suite,
                                       const Listener& listener);

}  // namespace oraclegs
