#pragma once
// How training went: train.csv.

#include <cstdint>
#include <filesystem>
#include <limits>
#include <nlohmann/json_fwd.hpp>
#include <utility>
#include <vector>

#include "oraclegs/train/term_sums.h"

namespace oraclegs {

/// A row; NaN = no value. The terms are means over the iterations since the row before, of this process.
struct CurveRow {
  static constexpr double kNone = std::numeric_limits<double>::quiet_NaN();

  int64_t iteration = 0;
  double seconds = 0;  ///< of training until then, summed over resumed runs
  double loss = 0;     ///< smoothed over the iterations
  int64_t gaussians = 0;
  double milliseconds = kNone;      ///< an iteration takes, without what looks on
  double l1 = kNone, ssim = kNone;  ///< of photos: mean |render - image| and SSIM, where the mask counts
  double depth = kNone;             ///< of photos: the depth term, with its weight
  double alpha = kNone;             ///< likewise
  double proposal = kNone;          ///< the whole loss of iterations that took a proposal
  double regularization = kNone;    ///< of opacities and scales
  double psnr = kNone;              ///< dB, of the test views

  void SetTerms(const TermSums& sums);
};

/// True for the iterations of a training of `total` that have a row: at most 500, evenly apart, and the last one.
bool HasCurveRow(int64_t iteration, int64_t total);

/// The rows of train.csv as text, with a header.
std::string CurvesToCsv(const std::vector<CurveRow>& rows);

/// train.csv while it grows: whoever kills the run leaves the rows before its last checkpoint.
class CurvesFile {
 public:
  explicit CurvesFile(std::filesystem::path path) : path_(std::move(path)) {}
  ~CurvesFile() { Close(); }
  CurvesFile(const CurvesFile&) = delete;
  CurvesFile& operator=(const CurvesFile&) = delete;

  /// Replaces the file. Throws RunError, as all of this class.
  void Write(const std::vector<CurveRow>& rows);
  /// Adds the last of `rows`, which is one more than at the last call; after a failed call, all that are missing.
  void Append(const std::vector<CurveRow>& rows);

 private:
  void Close();

  std::filesystem::path path_;
  int fd_ = -1;  ///< open for appending; -1 = the file may lack rows
};

/// The rows of such a file, without those that are damaged; empty when there is none.
std::vector<CurveRow> ReadCurves(const std::filesystem::path& path);

/// [{"name": "loss", "unit", "x_name", "x": [...], "y": [...]}, ...] of loss, Gaussians and, where it was measured,
/// PSNR over the iterations.
nlohmann::json CurvesToJson(const std::vector<CurveRow>& rows);

}  // namespace oraclegs
