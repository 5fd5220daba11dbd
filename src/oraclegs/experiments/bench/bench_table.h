#pragma once
// What a benchmark measured, and the rows of its tables: means, deviations, who is best.

#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "oraclegs/experiments/ablation_report.h"
#include "oraclegs/experiments/bench/published.h"

namespace oraclegs {

/// What is tabulated of a run.
enum class BenchValue { kPsnr, kSsim, kLpips, kSeconds, kCpuSeconds, kPeakBytes, kGaussians };
inline constexpr size_t kBenchValues = 7;
inline constexpr size_t kBenchScores = 3;  ///< the first of them, which papers print
inline constexpr std::array kBenchValueKeys = {"psnr",        "ssim",       "lpips",    "seconds",
                                               "cpu_seconds", "peak_bytes", "gaussians"};

/// One run: of one scene, number of training views, method and seed.
struct BenchScore {
  std::string scene;
  int views = 0;  ///< as asked for; 0 = all
  std::string method;
  uint64_t seed = 0;
  std::string workspace;                                    ///< relative to the benchmark's folder
  bool ended = false;                                       ///< false: it has not been run yet
  std::string failure;                                      ///< why there are no scores; "" = there are, once ended
  std::array<std::optional<double>, kBenchValues> value{};  ///< seconds: from photos to the trained model
  double training_seconds = 0;
  size_t train_views = 0;
  std::string version;  ///< of the program that ran it
  std::string lpips;    ///< how it was computed; "" = it was not

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
  std::vector<BenchScore> runs;  ///< all that are planned, also of scenes that cannot be run
  bool compares = false;         ///< the runs kept the protocol: published scores stand beside them
  std::vector<std::string> notes;
};

/// A row of a table: a method in one scene, its mean over scenes, or what a paper prints.
struct BenchRow {
  int views = 0;
  std::string scene = {};               ///< "" = mean over the scenes
  std::string method = {}, label = {};  ///< of the method
  std::string source = {};              ///< not "": quoted from there
  std::string version = {};             ///< of the program that made the runs, "; " between several
  std::string failure = {};             ///< in place of numbers where there are none
  size_t scored = 0, of = 0;            ///< runs of a scene; scenes of a mean
  std::array<std::optional<Spread>, kBenchValues> value{};
  std::array<bool, kBenchScores> best{};         ///< among the methods of this scene or mean, as it is printed
  std::optional<PublishedScore> published = {};  ///< of a mean over all scenes

  bool is_mean() const { return scene.empty(); }
};

/// For each number of views: the rows of each scene, the means, and what is quoted of methods that were not run. The
/// deviation of a scene is over seeds; that of a mean is over seeds, too, of the mean over the scenes that have scores.
std::vector<BenchRow> BenchRows(const BenchReport& report);

/// How often each method of the report has the best PSNR of a scene, of the scenes in which two methods or more have
/// scores (`of`).
struct BenchWins {
  std::vector<size_t> wins;
  size_t of = 0;
};
BenchWins CountWins(const BenchReport& report, int views);

/// "27.01 ± 0.12", 2 decimals of PSNR and 4 of the others; "-" for none.
std::string ScoreCell(const std::optional<Spread>& spread, BenchValue value);

/// Ours less what is published; nothing where one is missing.
std::optional<double> DifferenceToPublished(const BenchRow& row, BenchValue value);
std::optional<double> PublishedValue(const PublishedScore& score, BenchValue value);

}  // namespace oraclegs
