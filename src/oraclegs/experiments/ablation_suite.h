#pragma once
// Ablations of several scenes, and their mean.

#include "oraclegs/experiments/ablation.h"

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

/// The request for one of several scenes, in its folder.
AblationRequest InFolder(const AblationRequest& request, const std::filesystem::path& scene);

/// Writes out/ablation.json and out/ablation.md.
void WriteAblation(const std::filesystem::path& out, const nlohmann::json& report, const std::string& table);

/// Commands of these trainings (AblationCommands).
std::string SceneCommands(const AblationRequest& request, const std::vector<std::filesystem::path>& scenes);

}  // namespace oraclegs
