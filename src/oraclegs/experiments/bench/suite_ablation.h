#pragma once
// Ablations of a named suite: all its scenes at each of its numbers of training views, side by side.

#include <functional>

#include "oraclegs/experiments/ablation_suite.h"
#include "oraclegs/experiments/bench/scene_check.h"

namespace oraclegs {

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
