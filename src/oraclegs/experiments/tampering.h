#pragma once
// How far the oracle protects a result from proposals that lie in places (docs/method.md#tampering-benchmark).

#include <string>
#include <vector>

#include "oraclegs/experiments/ablation.h"
#include "oraclegs/experiments/tampering_report.h"

namespace oraclegs {

/// Trains, for each seed: proxy models, which are tampered with until shares of the pixels that they show at the
/// proposals' poses lie; then the scene without proposals, and for each share on these proposals alone, all pixels
/// trusted alike, as the oracle of a folder says, and as an ideal oracle would. What is the same by definition (ideal
/// of 0 and of 100 %) is not trained twice. Each training has a workspace, out/runs/seed-S/NAME; all share the
/// geometry. out/tampered/seed-S/share-P/ has the pictures, the masks and the ideal confidence,
/// out/tampered/seed-S/void/ what at most one photo sees. Writes out/tampering.json, .md and .svg anew after each
/// training; given again, it goes on where it was stopped. Throws UsageError for options that contradict the suite,
/// InputError when the scene cannot be read or shows too little for proposals, or `out` holds something else,
/// Interrupted, and what a training throws.
TamperingReport RunTampering(const AblationRequest& request, const Listener& listener);

/// "0,10,30" as whole per cents, rising, each once; 0, 10, 30, 50, 100 for "". Throws UsageError.
std::vector<int> ParseShares(const std::string& words);

}  // namespace oraclegs
