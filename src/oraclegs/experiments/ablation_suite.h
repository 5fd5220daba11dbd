#pragma once
// The same ablation of several scenes, and the mean over them.

#include "oraclegs/experiments/ablation.h"

namespace oraclegs {

/// Of each row and seed the mean over scenes, so that deviations are those of the mean between seeds. A row stands in
/// it that all scenes have; a seed that failed in one scene failed. Notes are those of all. `scenes` is not empty.
Ablation MeanOver(const std::vector<Ablation>& scenes);

/// RunAblation of request.run.scene and of options.also, each in out/NAME after its folder, and the mean in
/// out/ablation.json and out/ablation.md, written anew after each scene. Throws as RunAblation does, and UsageError
/// when two scenes have one name.
Ablation RunSuite(const AblationRequest& request, const Listener& listener);

}  // namespace oraclegs
