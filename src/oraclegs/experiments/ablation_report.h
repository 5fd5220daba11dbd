#pragma once
// What an ablation measured: its statistics, and the same as text, JSON and Markdown.

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
  std::optional<double> psnr, ssim, psnr_color_corrected;  ///< none without test pixels; dB
  std::optional<double> lpips;                             ///< none without its weights either
  double training_seconds = 0;
  int64_t gaussians = 0;
  std::string start;  ///< of what points
};

struct AblationResult {
  size_t number = 0;  ///< from 1
  std::string name, label, explanation;
  nlohmann::json changes = nlohmann::json::object();  ///< {option: value} that the row above in this table had not
  std::vector<AblationRun> runs;                      ///< those that ended, in any order
};

struct Ablation {
  std::string scene, command, version;
  std::vector<std::string> scenes = {};  ///< of a mean over several; then there are no numbers of views and pixels
  size_t train_views = 0, test_views = 0;
  int width = 0, height = 0;  ///< pixels of a training view
  int iterations = 0, max_gaussians = 0;
  std::vector<uint64_t> seeds;
  std::vector<AblationResult> rows;
  std::vector<std::string> notes;
};

struct Spread {
  size_t count = 0;
  double mean = 0;
  std::optional<double> deviation;  ///< of the sample; none of one value
};

/// None of no values.
std::optional<Spread> SpreadOf(const std::vector<double>& values);

/// PSNR of a row minus that of the nearest row above it that has scores, seed by seed. None where no seed has both.
struct Gain {
  size_t over = 0;  ///< index of the row above
  Spread psnr;
};
std::optional<Gain> GainOf(const Ablation& ablation, size_t row);

/// Everything, each seed. Spreads are {"mean", "deviation", "count"}; what there is none of is null.
nlohmann::json AblationToJson(const Ablation& ablation);

/// A table with a line for each row and each failure.
std::string AblationText(const Ablation& ablation);

/// A document with a heading, the table, what each row adds, and the notes.
std::string AblationMarkdown(const Ablation& ablation);

}  // namespace oraclegs
