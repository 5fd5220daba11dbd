#pragma once

#include <vector>

#include "oraclegs/pipeline/stages/propose_stage.h"
#include "oraclegs/train/train_view.h"

namespace oraclegs {

/// Stage "validate": has the oracle say how far each candidate can be trusted, makes one picture of the candidates of
/// each target, and maps its confidence so that it predicts the goodness hidden photographs had. Writes what is trained
/// on: proposals/NAME.png, confidence/NAME.png (8 bit, 255 = trust), confidence/preview/NAME.png (yellow = trust,
/// purple = do not, beside the proposal). Read back when nothing has changed. Proposals that are trusted nowhere are
/// left out, with a warning that names them.
std::vector<TrainView> RunValidate(Run* run, const std::vector<LoadedView>& photos, const Geometry& geometry,
                                   const ProposalPlan& plan);

}  // namespace oraclegs
