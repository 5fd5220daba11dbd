#include "oraclegs/output/live/curves.h"

#include <fcntl.h>
#include <unistd.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <iterator>
#include <nlohmann/json.hpp>
#include <sstream>
#include <string>

#include "oraclegs/core/error.h"
#include "oraclegs/core/files.h"

namespace oraclegs {
namespace {

constexpr int64_t kMaxRows = 500;
constexpr uint64_t kMaxBytes = 4 << 20;
constexpr const char* kHeader =
    "iteration,seconds,ms_per_iteration,loss,l1,ssim,depth,alpha,proposal,regularization,gaussians,psnr";

/// Text of a cell; empty for NaN.
std::string Cell(double value) { return std::isnan(value) ? "" : fmt::format("{:.7g}", value); }

std::string LineOf(const CurveRow& r) {
  return fmt::format("{},{:.3f},{},{},{},{},{},{},{},{},{},{}\n", r.iteration, r.seconds, Cell(r.milliseconds),
                     Cell(r.loss), Cell(r.l1), Cell(r.ssim), Cell(r.depth), Cell(r.alpha), Cell(r.proposal),
                     Cell(r.regularization), r.gaussians, Cell(r.psnr));
}

std::vector<std::string> CellsOf(const std::string& line) {
  std::vector<std::string> cells(1);
  for (const char c : line) {
    if (c == ',') {
      cells.emplace_back();
    } else {
      cells.back() += c;
    }
  }
  return cells;
}

/// Reads a cell; an empty one is NaN. Returns false for text that is no number.
bool ReadCell(const std::string& cell, double* value) {
  *value = CurveRow::kNone;
  if (cell.empty()) return true;
  const auto [end, error] = std::from_chars(cell.data(), cell.data() + cell.size(), *value);
  return error == std::errc() && end == cell.data() + cell.size();
}

/// Reads a line. Returns false for a damaged line, and for the header.
bool ReadLine(const std::string& line, CurveRow* row) {
  const std::vector<std::string> cells = CellsOf(line);
  double iteration = 0, gaussians = 0;
  double* const values[] = {&iteration,     &row->seconds,        &row->milliseconds, &row->loss,
                            &row->l1,       &row->ssim,           &row->depth,        &row->alpha,
                            &row->proposal, &row->regularization, &gaussians,         &row->psnr};
  if (cells.size() != std::size(values)) return false;
  for (size_t i = 0; i < cells.size(); ++i) {
    if (!ReadCell(cells[i], values[i])) return false;
  }
  if (!(iteration > 0 && iteration < 1e15 && gaussians >= 0 && gaussians < 1e15)) return false;
  row->iteration = static_cast<int64_t>(iteration), row->gaussians = static_cast<int64_t>(gaussians);
  return std::isfinite(row->loss) && std::isfinite(row->seconds);
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
  Write(rows);  // all rows anew, so that no half line stays
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
      if (ReadLine(line, &row) && (rows.empty() || row.iteration > rows.back().iteration)) rows.push_back(row);
    }
  } catch (const InputError&) {  // no regular file, or far too large: no curves
  }
  return rows;
}

void CurveRow::SetTerms(const TermSums& sums) {
  const auto photos = static_cast<double>(sums.photos), proposals = static_cast<double>(sums.proposals);
  if (sums.photos > 0) {
    l1 = sums.l1 / photos, ssim = 1 - sums.dssim / photos;
    depth = sums.depth / photos, alpha = sums.alpha / photos;
  }
  if (sums.proposals > 0) proposal = sums.proposal / proposals;
  if (sums.photos + sums.proposals > 0) regularization = sums.regularization / (photos + proposals);
}

nlohmann::json CurvesToJson(const std::vector<CurveRow>& rows) {
  const auto curve = [](const char* name, const char* unit) {
    return nlohmann::json{{"name", name},
                          {"unit", unit},
                          {"x_name", "iteration"},
                          {"x", nlohmann::json::array()},
                          {"y", nlohmann::json::array()}};
  };
  const auto add = [](nlohmann::json* to, int64_t x, const auto& y) {
    (*to)["x"].push_back(x);
    (*to)["y"].push_back(y);
  };
  nlohmann::json loss = curve("loss", ""), gaussians = curve("Gaussians", ""), psnr = curve("PSNR of test views", "dB");
  // A file of another program may have any number of rows.
  const size_t step = std::max<size_t>(1, (rows.size() + kMaxRows - 1) / kMaxRows);
  for (size_t i = step - 1; i < rows.size(); i += step) {
    add(&loss, rows[i].iteration, rows[i].loss);
    add(&gaussians, rows[i].iteration, rows[i].gaussians);
  }
  std::vector<const CurveRow*> scored;
  for (const CurveRow& row : rows) {
    if (std::isfinite(row.psnr)) scored.push_back(&row);
  }
  const size_t scored_step = std::max<size_t>(1, (scored.size() + kMaxRows - 1) / kMaxRows);
  for (size_t i = scored_step - 1; i < scored.size(); i += scored_step) {
    add(&psnr, scored[i]->iteration, scored[i]->psnr);
  }
  nlohmann::json curves = nlohmann::json::array({std::move(loss), std::move(gaussians)});
  if (!scored.empty()) curves.push_back(std::move(psnr));
  return curves;
}

}  // namespace oraclegs
