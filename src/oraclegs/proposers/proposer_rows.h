#pragma once

#include <vector>

#include "oraclegs/stages/proposer_row.h"

namespace oraclegs {

/// The proposers there are, in the order of their candidates.
const std::vector<ProposerRow>& ProposerRows();

}  // namespace oraclegs
