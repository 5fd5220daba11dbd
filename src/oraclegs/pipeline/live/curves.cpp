#include "oraclegs/pipeline/live/curves.h"

#include <fcntl.h>
#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <nlohmann/json.hpp>
#include <sstream>
#include <string>

#include "oraclegs/core/error.h"
#include "oraclegs/core/files.h"

namespace oraclegs {
namespace {

constexpr int64_t kMaxRows = 500;
constexpr uint64_t kMaxBytes = 4 << 20;
constexpr const char* kHeader = "iteration,seconds,loss,gaussians";

std::string LineOf(const CurveRow& row) {
  return fmt::format("{},{:.3f},{:.7g},{}\n", row.iteration, row.seconds, row.loss, row.gaussians);
}

}  // namespace

bool HasCurveRow(int64_t iteration, int64_t total) {
  const int64_t every = std::max<int64_t>(1, (total + kMaxRows - 1) / kMaxRows);
  return iteration > 0 && (iteration % every == 0 || iteration == total);
}

std::string CurvesToCsv(const std::vector<CurveRow>& rows) {
  std::string text = std::string(kHeader) + "\n";
  for (const CurveRow& row : rows) text += LineOf(row);
  return text;
}

void CurvesFile::Write(const std::vector<CurveRow>& rows) {
  Close();
  ReplaceFile(path_, CurvesToCsv(rows));
  fd_ = open(path_.c_str(), O_WRONLY | O_APPEND | O_CLOEXEC);
}

void CurvesFile::Append(const std::vector<CurveRow>& rows) {
  const std::string line = LineOf(rows.back());
  if (fd_ >= 0 && write(fd_, line.data(), line.size()) == static_cast<ssize_t>(line.size())) return;
  Write(rows);  // the whole, so that no half of a line stays
}

void CurvesFile::Close() {
  if (fd_ >= 0) close(std::exchange(fd_, -1));
}

std::vector<CurveRow> ReadCurves(const std::filesystem::path& path) {
  std::error_code ignored;
  if (!std::filesystem::exists(path, ignored)) return {};
  std::vector<CurveRow> rows;
  try {
    std::istringstream text(ReadFile(path, kMaxBytes));
    for (std::string line; std::getline(text, line);) {
      CurveRow row;
      long long iteration = 0, gaussians = 0;
      char rest = 0;
      if (std::sscanf(line.c_str(), "%lld,%lf,%lf,%lld%c", &iteration, &row.seconds, &row.loss, &gaussians, &rest) != 4)
        continue;
      row.iteration = iteration, row.gaussians = gaussians;
      const bool follows = rows.empty() || iteration > rows.back().iteration;
      if (follows && iteration > 0 && std::isfinite(row.loss) && std::isfinite(row.seconds)) rows.push_back(row);
    }
  } catch (const InputError&) {  // no regular file, or far too large: no curves
  }
  return rows;
}

nlohmann::json CurvesToJson(const std::vector<CurveRow>& rows) {
  nlohmann::json loss = {{"name", "loss"}, {"unit", ""}, {"x_name", "iteration"}};
  nlohmann::json gaussians = {{"name", "Gaussians"}, {"unit", ""}, {"x_name", "iteration"}};
  for (nlohmann::json* curve : {&loss, &gaussians}) (*curve)["x"] = (*curve)["y"] = nlohmann::json::array();
  // A file of another program may have any number.
  const size_t step = std::max<size_t>(1, (rows.size() + kMaxRows - 1) / kMaxRows);
  for (size_t i = step - 1; i < rows.size(); i += step) {
    loss["x"].push_back(rows[i].iteration);
    loss["y"].push_back(rows[i].loss);
    gaussians["x"].push_back(rows[i].iteration);
    gaussians["y"].push_back(rows[i].gaussians);
  }
  return nlohmann::json::array({std::move(loss), std::move(gaussians)});
}

}  // namespace oraclegs
