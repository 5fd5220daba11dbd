#pragma once
// Measures how well the oracle protects a result from proposals that are partly wrong
// (docs/method.md#tampering-benchmark).

#include <string>
#include <vector>

#include "oraclegs/experiments/ablation.h"
#include "oraclegs/experiments/tampering_report.h"

namespace oraclegs {

/// Trains, for each seed: proxy models, which are tampered with until given shares of the pixels that they show at the
/// proposals' poses are wrong; the scene without proposals; and, for each share, the scene on these proposals alone,
/// with all pixels trusted alike, with the oracle of a folder, and with an ideal oracle. Trainings that are equal by
/// definition (ideal at 0 and at 100 %) are done once. Each training has a workspace, out/runs/seed-S/NAME; all share
/// the geometry. out/tampered/seed-S/share-P/ has the pictures, the masks and the ideal confidence,
/// out/tampered/seed-S/void/ the masks of pixels that at most one photo sees. Rewrites out/tampering.json, .md and .svg
/// after each training; a second call continues where the first was stopped. Throws UsageError for options that
/// contradict the suite; InputError when the scene cannot be read or shows too little for proposals, or `out` holds
/// something else; Interrupted; and the errors of a training.
TamperingReport RunTampering(const AblationRequest& request, const Listener& listener);

/// Parses "0,10,30": whole per cents, ascending, each once; 0, 10, 30, 50, 100 for "". Throws UsageError.
std::vector<int> ParseShares(const std::string& words);

}  // namespace oraclegs
