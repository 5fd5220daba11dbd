#pragma once
// What the tampering benchmark measured: its statistics, and the same as text, JSON and Markdown
// (docs/method.md#tampering-benchmark).

#include <array>
#include <cstdint>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <vector>

#include "oraclegs/experiments/ablation_report.h"
#include "oraclegs/validate/tamper_gaussians.h"

namespace oraclegs {

/// How far proposals are trusted.
enum class TamperingTrust {
  kNone,     ///< there are no proposals
  kUniform,  ///< in all pixels alike
  kOracle,   ///< as the oracle says
  kIdeal,    ///< in the honest pixels alone
};
inline constexpr std::array kTamperingTrustNames = {"none", "uniform", "oracle", "ideal"};

/// One training.
struct TamperingRun {
  uint64_t seed = 0;
  TamperingTrust trust = TamperingTrust::kNone;
  std::string workspace;       ///< relative to the benchmark's folder
  std::optional<double> psnr;  ///< of the test views, dB; none without test pixels
};

/// What the oracle says of the proposals of one seed; numbers that there are no pixels for are none.
struct TamperedConfidence {
  uint64_t seed = 0;
  double tampered = 0;               ///< share of the pixels, [0, 1]
  size_t lies = 0;                   ///< tampered balls
  std::optional<double> auroc;       ///< of low confidence as a sign of a tampered pixel, where >= 2 photos see
  std::optional<double> auroc_void;  ///< the same where at most one does
  std::optional<double> on_tampered, on_honest;  ///< mean confidence, [0, 1]
  /// auroc of what one kind of lie makes differ by itself, against honest pixels.
  std::array<std::optional<double>, kGaussianTamperKinds> auroc_of_kind = {};
};

/// A row of the table.
struct TamperingShare {
  int percent = 0;                 ///< that was asked for, of all proposals' pixels
  std::vector<TamperingRun> runs;  ///< those that ended; those without proposals stand in TamperingReport
  std::vector<TamperedConfidence> confidence = {};
};

struct TamperingReport {
  std::string scene, command, version;
  size_t train_views = 0, test_views = 0, proposals = 0;
  int width = 0, height = 0;  ///< pixels of a training view
  int iterations = 0, max_gaussians = 0;
  std::vector<uint64_t> seeds;
  std::vector<TamperingRun> none;  ///< the trainings without proposals
  std::vector<TamperingShare> shares;
  std::vector<std::string> notes;
};

/// Test PSNR over the seeds that have been scored, dB; of TamperingTrust::kNone the same for each share.
std::optional<Spread> TamperingPsnr(const TamperingReport& report, size_t share, TamperingTrust trust);

/// (oracle - uniform) / (ideal - uniform), of mean PSNR: 1 = the oracle helps as much as an ideal one, 0 = as much as
/// none, below 0 = it harms. None where one is missing, or where the ideal one gains less than kMinIdealGain.
std::optional<double> TamperingRecovery(const TamperingReport& report, size_t share);
inline constexpr double kMinIdealGain = 0.05;  ///< dB

/// The smallest difference oracle - none of mean PSNR over the shares, dB; none before both have scores.
std::optional<double> WorstOverNone(const TamperingReport& report);

/// Everything, each seed; what there is none of is null.
nlohmann::json TamperingToJson(const TamperingReport& report);
/// A table with a line for each share, the worst difference, and the AUROC of each kind of lie.
std::string TamperingText(const TamperingReport& report);
/// A document with a heading, the plot (tampering.svg), the tables, what their columns are, and the notes.
std::string TamperingMarkdown(const TamperingReport& report);

}  // namespace oraclegs
