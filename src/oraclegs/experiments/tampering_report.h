#pragma once
// Results of the tampering benchmark: statistics, and reports as text, JSON and Markdown
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

/// Trust in the pixels of proposals.
enum class TamperingTrust {
  kNone,     ///< no proposals
  kUniform,  ///< all pixels alike
  kOracle,   ///< the oracle's confidence
  kIdeal,    ///< honest pixels only
};
inline constexpr std::array kTamperingTrustNames = {"none", "uniform", "oracle", "ideal"};

/// One training.
struct TamperingRun {
  uint64_t seed = 0;
  TamperingTrust trust = TamperingTrust::kNone;
  std::string workspace;       ///< relative to the benchmark's folder
  std::optional<double> psnr;  ///< test PSNR, dB; nullopt without test pixels
};

/// Confidence of the oracle in the proposals of one seed; a metric without pixels is nullopt.
struct TamperedConfidence {
  uint64_t seed = 0;
  double tampered = 0;               ///< tampered share of the pixels, [0, 1]
  size_t lies = 0;                   ///< number of tampered balls
  std::optional<double> auroc;       ///< low confidence as a sign of a tampered pixel, where at least 2 photos see it
  std::optional<double> auroc_void;  ///< low confidence as a sign of a tampered pixel, where at most one photo sees it
  std::optional<double> on_tampered, on_honest;  ///< mean confidence, [0, 1]
  /// AUROC of each tampering kind alone against untouched pixels.
  std::array<std::optional<double>, kGaussianTamperKinds> auroc_of_kind = {};
};

/// Row of the table.
struct TamperingShare {
  int percent = 0;                 ///< asked-for share of all proposals' pixels
  std::vector<TamperingRun> runs;  ///< runs that ended; those without proposals are in TamperingReport
  std::vector<TamperedConfidence> confidence = {};
};

struct TamperingReport {
  std::string scene, command, version;
  size_t train_views = 0, test_views = 0, proposals = 0;
  int width = 0, height = 0;  ///< pixels of a training view
  int iterations = 0, max_gaussians = 0;
  std::vector<uint64_t> seeds;
  std::vector<TamperingRun> none;  ///< trainings without proposals
  std::vector<TamperingShare> shares;
  std::vector<std::string> notes;
};

/// Test PSNR over the scored seeds, dB; TamperingTrust::kNone does not depend on the share.
std::optional<Statistic> TamperingPsnr(const TamperingReport& report, size_t share, TamperingTrust trust);

/// (oracle - uniform) / (ideal - uniform), of mean PSNR: 1 = the oracle helps as much as an ideal one, 0 = as much as
/// none, below 0 = it harms. nullopt where one is missing, or where the ideal one gains less than kMinIdealGain.
std::optional<double> TamperingRecovery(const TamperingReport& report, size_t share);
inline constexpr double kMinIdealGain = 0.05;  ///< dB

/// Smallest difference oracle - none of mean PSNR over the shares, dB; nullopt until both have scores.
std::optional<double> WorstOverNone(const TamperingReport& report);

/// JSON with every seed; missing values are null.
nlohmann::json TamperingToJson(const TamperingReport& report);
/// Table with a line for each share, the worst difference, and the AUROC of each tampering kind.
std::string TamperingText(const TamperingReport& report);
/// Document with a heading, the plot (tampering.svg), the tables, explanations of their columns, and the notes.
std::string TamperingMarkdown(const TamperingReport& report);

/// Test PSNR over the tampered share as an SVG image: a line, with its name, for each trust that has scores.
std::string TamperingPlot(const TamperingReport& report);

}  // namespace oraclegs
