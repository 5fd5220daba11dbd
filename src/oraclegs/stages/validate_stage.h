#pragma once

#include "oraclegs/stages/stage.h"

namespace oraclegs {

/// Stage "validate": has the oracle classify each candidate, makes one image of the candidates of each target, and maps
/// its confidence so that it predicts the similarity held-out views had. Writes what is trained on: proposals/NAME.png,
/// confidence/NAME.png (8 bit, 255 = trust), confidence/preview/NAME.png (yellow = trust, purple = do not, beside the
/// proposal). Proposals that are trusted nowhere are left out, with a warning that names them.
StageWork ValidateStage();

}  // namespace oraclegs
