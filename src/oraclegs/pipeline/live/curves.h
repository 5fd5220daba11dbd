#pragma once
// How training went: curves.csv.

#include <cstdint>
#include <filesystem>
#include <nlohmann/json_fwd.hpp>
#include <utility>
#include <vector>

namespace oraclegs {

struct CurveRow {
  int64_t iteration = 0;
  double seconds = 0;  ///< of training until then, summed over resumed runs
  double loss = 0;     ///< smoothed over the iterations
  int64_t gaussians = 0;
};

/// True for the iterations of a training of `total` that have a row: at most 500, evenly apart, and the last one.
bool HasCurveRow(int64_t iteration, int64_t total);

/// The rows of curves.csv as text, with a header.
std::string CurvesToCsv(const std::vector<CurveRow>& rows);

/// curves.csv while it grows: whoever kills the run leaves the rows before its last checkpoint.
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

/// [{"name": "loss", "unit", "x_name", "x": [...], "y": [...]}, ...] of loss and Gaussians over the iterations.
nlohmann::json CurvesToJson(const std::vector<CurveRow>& rows);

}  // namespace oraclegs
