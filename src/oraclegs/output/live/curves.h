#pragma once
// Curves of a training: train.csv.

#include <cstdint>
#include <filesystem>
#include <limits>
#include <nlohmann/json_fwd.hpp>
#include <utility>
#include <vector>

#include "oraclegs/train/observer.h"

namespace oraclegs {

/// A row; NaN = no value. The terms are means over the iterations since the row before, in this process.
struct CurveRow {
  static constexpr double kNone = std::numeric_limits<double>::quiet_NaN();

  int64_t iteration = 0;
  double seconds = 0;  ///< training time until then, summed over resumed runs
  double loss = 0;     ///< smoothed over the iterations
  int64_t gaussians = 0;
  double milliseconds = kNone;      ///< time of an iteration, without that of observers
  double l1 = kNone, ssim = kNone;  ///< photos: mean |render - image| and SSIM, inside the mask
  double depth = kNone;             ///< photos: the depth term, with its weight
  double alpha = kNone;             ///< photos: the alpha term, with its weight
  double proposal = kNone;          ///< whole loss of iterations with a proposal
  double regularization = kNone;    ///< terms of opacities and scales
  double psnr = kNone;              ///< test PSNR, dB

  void SetTerms(const TermSums& sums);
};

/// True for iterations that have a row, in a training of `total`: at most 500, evenly spaced, and the last one.
bool HasCurveRow(int64_t iteration, int64_t total);

/// CSV text of the rows, with a header.
std::string CurvesToCsv(const std::vector<CurveRow>& rows);

/// train.csv while it grows. A run that is killed keeps the rows before its last checkpoint.
class CurvesFile {
 public:
  explicit CurvesFile(std::filesystem::path path) : path_(std::move(path)) {}
  ~CurvesFile() { Close(); }
  CurvesFile(const CurvesFile&) = delete;
  CurvesFile& operator=(const CurvesFile&) = delete;

  /// Replaces the file. Like all functions of this class, throws RunError.
  void Write(const std::vector<CurveRow>& rows);
  /// Appends the last of `rows`, which is one more than at the last call; after a failed call, all that are missing.
  void Append(const std::vector<CurveRow>& rows);

 private:
  void Close();

  std::filesystem::path path_;
  int fd_ = -1;  ///< open for appending; -1 = the file may lack rows
};

/// Rows of train.csv, without damaged ones; empty when there is no file.
std::vector<CurveRow> ReadCurves(const std::filesystem::path& path);

/// [{"name": "loss", "unit", "x_name", "x": [...], "y": [...]}, ...] for loss, Gaussians and, where measured, PSNR over
/// the iterations.
nlohmann::json CurvesToJson(const std::vector<CurveRow>& rows);

}  // namespace oraclegs
