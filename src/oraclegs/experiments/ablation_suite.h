#pragma once
// Ablations of several scenes, and their mean.

#include "oraclegs/experiments/ablation.h"

namespace oraclegs {

/// Mean over scenes for each row and seed, so that deviations are those of the mean between seeds. It has the rows that
/// all scenes have; a seed that failed in one scene counts as failed. Notes are those of all scenes. `scenes` must not
/// be empty.
Ablation MeanOver(const std::vector<Ablation>& scenes);

/// Runs RunAblation for request.run.scene and each of options.also in out/NAME, named after its folder. Rewrites the
/// mean, out/ablation.json and out/ablation.md, after each scene. Throws as RunAblation does, and UsageError when two
/// scenes have one name.
Ablation RunSuite(const AblationRequest& request, const Listener& listener);

}  // namespace oraclegs
