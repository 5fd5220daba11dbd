#pragma once
// Results of a benchmark, and the rows of its tables: means, deviations, the best.

#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "oraclegs/experiments/ablation_report.h"
#include "oraclegs/experiments/bench/published.h"

namespace oraclegs {

/// Columns of a run in the tables.
enum class BenchValue { kPsnr, kSsim, kLpips, kSeconds, kCpuSeconds, kPeakBytes, kGaussians };
inline constexpr size_t kBenchValues = 7;
inline constexpr size_t kBenchScores = 3;  ///< number of scores among them, which come first
inline constexpr std::array kBenchValueKeys = {"psnr",        "ssim",       "lpips",    "seconds",
                                               "cpu_seconds", "peak_bytes", "gaussians"};

/// Result of one run: one scene, number of training views, method and seed.
struct BenchScore {
  std::string scene;
  int views = 0;  ///< as asked for; 0 = all
  std::string method;
  uint64_t seed = 0;
  std::string workspace;  ///< relative to the benchmark's folder
  bool ended = false;     ///< false until it has been run
  std::string failure;    ///< reason why there are no scores; "" = there are, once ended
  std::array<std::optional<double>, kBenchValues> value{};  ///< seconds are from photos to the trained model
  double training_seconds = 0;
  size_t train_views = 0;
  std::string version;  ///< version of the program that ran it
  std::string lpips;    ///< how it was computed; "" = not computed

  bool is_scored() const { return ended && failure.empty(); }
};

struct BenchMethod {
  std::string name, label, citation;
};

struct BenchReport {
  std::string suite, label;  ///< for files, for people
  std::string command, version;
  std::vector<std::string> scenes;
  std::vector<int> views;
  std::vector<BenchMethod> methods;
  std::vector<uint64_t> seeds;
  std::vector<BenchScore> runs;  ///< all planned runs, including those of scenes that cannot be run
  bool compares = false;         ///< true when the runs kept the protocol: published scores are shown beside them
  std::vector<std::string> notes;
};

/// Row of a table: a method in one scene, its mean over scenes, or a quote from a paper.
struct BenchRow {
  int views = 0;
  std::string scene = {};               ///< "" = mean over the scenes
  std::string method = {}, label = {};  ///< name and label of the method
  std::string source = {};              ///< source of a quote; "" = measured
  std::string version = {};             ///< versions of the program that made the runs, joined by "; "
  std::string failure = {};             ///< replaces the numbers of a row without scores
  size_t scored = 0, of = 0;            ///< runs of a scene; scenes of a mean
  std::array<std::optional<Statistic>, kBenchValues> value{};
  std::array<bool, kBenchScores> best{};         ///< best among the methods of this scene or mean, as printed
  std::optional<PublishedScore> published = {};  ///< set for means over all scenes

  bool is_mean() const { return scene.empty(); }
};

/// Rows for each number of views: those of each scene, the means, and quotes of methods that were not run. Deviations
/// are over seeds; that of a mean is the deviation of the mean over the scenes that have scores.
std::vector<BenchRow> BenchRows(const BenchReport& report);

/// Number of scenes in which each method of the report has the best PSNR. `of` counts the scenes in which at least two
/// methods have scores.
struct BenchWins {
  std::vector<size_t> wins;
  size_t of = 0;
};
BenchWins CountWins(const BenchReport& report, int views);

/// "27.01 ± 0.12", 2 decimals for PSNR, 4 for the others; "-" for nullopt.
std::string ScoreCell(const std::optional<Statistic>& statistic, BenchValue value);

/// Our score minus the published one; nullopt where one is missing.
std::optional<double> DifferenceToPublished(const BenchRow& row, BenchValue value);
std::optional<double> PublishedValue(const PublishedScore& score, BenchValue value);

}  // namespace oraclegs
