#pragma once
// Results of an ablation: statistics, and reports as text, JSON and Markdown.

#include <cstdint>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <vector>

namespace oraclegs {

/// One training of a row, scored or failed.
struct AblationRun {
  uint64_t seed = 0;
  std::string workspace;                                   ///< relative to the ablation's folder
  std::string failure;                                     ///< why there are no scores; "" = there are
  std::optional<double> psnr, ssim, psnr_color_corrected;  ///< nullopt without test pixels; PSNR in dB
  std::optional<double> lpips;                             ///< nullopt without test pixels or weights
  double training_seconds = 0;
  int64_t gaussians = 0;
  std::string start;  ///< source of the initial points
};

struct AblationResult {
  size_t number = 0;  ///< from 1
  std::string name, label, explanation;
  nlohmann::json changes = nlohmann::json::object();  ///< {option: value} that differ from the row above in this table
  std::vector<AblationRun> runs;                      ///< runs that ended, in any order
};

struct Ablation {
  std::string scene, command, version;
  std::vector<std::string> scenes = {};  ///< scenes of a mean over several; views and pixels are then 0
  size_t train_views = 0, test_views = 0;
  /// 12 or 24 where images are those of the paper's table 3 (ablation_rows.h): its numbers stand beside a mean over
  /// all scenes of that table.
  int published_views = 0;
  int width = 0, height = 0;  ///< pixels of a training view
  int iterations = 0, max_gaussians = 0;
  std::vector<uint64_t> seeds;
  std::vector<AblationResult> rows;
  std::vector<std::string> notes;
};

struct Statistic {
  size_t count = 0;
  double mean = 0;
  std::optional<double> deviation;  ///< standard deviation of the sample; nullopt for one value
};

/// Mean and deviation of values; nullopt for an empty list.
std::optional<Statistic> StatisticOf(const std::vector<double>& values);

/// PSNR of a row minus that of the nearest row above it that has scores, seed by seed; nullopt where no seed has both.
struct Gain {
  size_t over = 0;  ///< index of the row above
  Statistic psnr;
};
std::optional<Gain> GainOf(const Ablation& ablation, size_t row);

/// JSON with every row and seed. Statistics are {"mean", "deviation", "count"}; missing values are null.
nlohmann::json AblationToJson(const Ablation& ablation);

/// Table with a line for each row and each failure.
std::string AblationText(const Ablation& ablation);

/// Scores of each row at each number of training views, which the ablations have as train_views, side by side: a table
/// for a terminal, and a document. `ablations` must not be empty.
std::string SideBySideText(const std::vector<Ablation>& ablations);
std::string SideBySideMarkdown(const std::vector<Ablation>& ablations);

/// Document with a heading, the table, the gain of each row, and the notes.
std::string AblationMarkdown(const Ablation& ablation);

}  // namespace oraclegs
