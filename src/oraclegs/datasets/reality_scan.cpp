#include "oraclegs/datasets/reality_scan.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <charconv>
#include <cmath>
#include <map>
#include <numbers>

#include "oraclegs/core/error.h"
#include "oraclegs/core/files.h"
#include "oraclegs/core/text.h"
#include "oraclegs/datasets/dataset_images.h"
#include "oraclegs/datasets/pose_files.h"
#include "oraclegs/image/read_image.h"
#include "oraclegs/scene/brown_lens.h"

namespace oraclegs {
namespace {

namespace fs = std::filesystem;

constexpr std::string_view kCsvBegin = "#name,x,y,alt,heading,pitch,roll,f";
constexpr double kFilmLength = 36;  // millimeters

fs::path RealityScanFile(const fs::path& root) {
  for (const fs::path& path : FilesThatEnd(root, ".csv")) {
    const std::string head = HeadOfPoseFile(path);
    const size_t end = kCsvBegin.size();
    if (head.starts_with(kCsvBegin) && head.size() > end &&
        std::string_view(",\r\n").find(head[end]) != std::string::npos)
      return path;
  }
  return {};
}

/// The cells of a line, also empty ones.
std::vector<std::string> CellsOf(const std::string& line) {
  std::vector<std::string> cells;
  for (size_t begin = 0; begin <= line.size();) {
    const size_t end = std::min(line.find(',', begin), line.size());
    const std::vector<std::string> word = SplitTrimmed(line.substr(begin, end - begin), '\n');
    cells.push_back(word.empty() ? "" : word.front());
    begin = end + 1;
  }
  return cells;
}

/// A line by the names of its columns.
struct CsvRow {
  const std::map<std::string, size_t>& columns;
  std::vector<std::string> cells;
  std::string place;

  double Number(const char* column) const {
    const std::string& cell = cells[columns.at(column)];
    double value = 0;
    const auto [end, error] = std::from_chars(cell.data(), cell.data() + cell.size(), value);
    if (error == std::errc() && end == cell.data() + cell.size() && std::isfinite(value)) return value;
    throw InputError("{}: {} is '{}', expected a number with a point", place, column, Printable(cell));
  }

  double NumberOrZero(const char* column) const { return columns.count(column) > 0 ? Number(column) : 0; }
};

struct CameraTable {
  std::map<std::string, size_t> columns;
  size_t width = 0;  ///< columns of the first line, of which some may have one name
  std::vector<std::pair<std::vector<std::string>, int>> rows;  ///< cells and line
};

CameraTable ParseTable(const std::string& text, const std::string& file) {
  CameraTable table;
  int number = 0;
  for (size_t begin = 0; begin < text.size();) {
    const size_t end = std::min(text.find('\n', begin), text.size());
    const std::string line = text.substr(begin, end - begin);
    begin = end + 1;
    std::vector<std::string> cells = CellsOf(line);
    if (++number == 1) {
      table.width = cells.size();
      for (size_t c = 0; c < table.width; ++c) table.columns.emplace(cells[c], c);
      continue;
    }
    if (cells.size() == 1 && cells[0].empty()) continue;
    if (cells.size() < table.width) {
      throw InputError("{}: line {}: has {}, and the first line names {}; is the file cut short?", file, number,
                       Counted(cells.size(), "cell"), table.width);
    }
    table.rows.emplace_back(std::move(cells), number);
  }
  if (table.rows.empty()) throw InputError("{}: names no photo; align the photos before you export them", file);
  return table;
}

double OffsetOfCenter(const CsvRow& row, const char* column) {
  const double share = row.NumberOrZero(column);
  if (std::abs(share) < 0.5) return share;
  throw InputError("{}: {} is {}, expected a share of the longer side between -0.5 and 0.5", row.place, column, share);
}

void FillRealityScanCamera(const CsvRow& row, SceneView* view) {
  BrownLens lens;
  ReadImageSize(view->image_path, &lens.width, &lens.height);
  const double longer = std::max(lens.width, lens.height);
  lens.fx = lens.fy = row.Number("f") / kFilmLength * longer;
  lens.cx = lens.width / 2.0 + OffsetOfCenter(row, "px") * longer;
  lens.cy = lens.height / 2.0 + OffsetOfCenter(row, "py") * longer;
  lens.k = {row.NumberOrZero("k1"), row.NumberOrZero("k2"), row.NumberOrZero("k3"), row.NumberOrZero("k4")};
  lens.p1 = row.NumberOrZero("t1");
  lens.p2 = row.NumberOrZero("t2");
  view->intrinsics = IntrinsicsOf(lens, row.place);
  const Eigen::Matrix3d rotation = RotationOfAngles(row.Number("heading"), row.Number("pitch"), row.Number("roll"));
  const Eigen::Vector3d center(row.Number("x"), row.Number("y"), row.Number("alt"));
  view->cam_from_world = Eigen::Isometry3d::Identity();
  view->cam_from_world->linear() = rotation;
  view->cam_from_world->translation() = -(rotation * center);
}

}  // namespace

bool IsRealityScanScene(const fs::path& root) { return !RealityScanFile(root).empty(); }

Eigen::Matrix3d RotationOfAngles(double heading, double pitch, double roll) {
  constexpr double kDegree = std::numbers::pi / 180;
  const Eigen::Matrix3d world_from_cam = (Eigen::AngleAxisd(-heading * kDegree, Eigen::Vector3d::UnitZ()) *
                                          Eigen::AngleAxisd(pitch * kDegree, Eigen::Vector3d::UnitX()) *
                                          Eigen::AngleAxisd(roll * kDegree, Eigen::Vector3d::UnitY()))
                                             .toRotationMatrix();
  const Eigen::DiagonalMatrix<double, 3> flip(1, -1, -1);  // from y up and z backward
  return flip * world_from_cam.transpose();
}

Scene ReadRealityScanScene(const fs::path& root, const SceneReadOptions& options, const Listener& listener) {
  const fs::path path = RealityScanFile(root);
  std::string text = ReadFile(path);
  text.erase(0, text.find('#'));  // a byte order mark
  const CameraTable table = ParseTable(text, path.string());
  std::vector<std::string> names;
  for (const auto& [cells, line] : table.rows) names.push_back(cells.front());
  const fs::path folder = DatasetImageFolder(root, options);
  std::vector<SceneView> views = ViewsOfNames(names, path.string(), folder, options, listener);
  for (size_t i = 0; i < views.size(); ++i) {
    const auto& [cells, line] = table.rows[i];
    const CsvRow row{table.columns, cells,
                     fmt::format("{}: line {} ({})", path.string(), line, OneLine(cells.front()))};
    if (!views[i].image_path.empty()) FillRealityScanCamera(row, &views[i]);
  }
  return SceneOfDataset(path, SceneFormat::kRealityScan, std::move(views), folder, listener);
}

}  // namespace oraclegs
