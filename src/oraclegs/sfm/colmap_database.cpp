#include "oraclegs/sfm/colmap_database.h"

#include <algorithm>
#include <array>
#include <cstring>

#include "oraclegs/core/error.h"
#include "oraclegs/sfm/database_file.h"

namespace oraclegs {
namespace {

namespace fs = std::filesystem;

/// The 3x3 matrix of doubles, row by row, in a column; nothing when it is not one or is zero.
std::optional<Eigen::Matrix3d> GetMatrix(sqlite3_stmt* row, int column) {
  const void* bytes = sqlite3_column_blob(row, column);
  Eigen::Matrix<double, 3, 3, Eigen::RowMajor> matrix;
  if (bytes == nullptr || sqlite3_column_bytes(row, column) != static_cast<int>(sizeof(matrix))) return std::nullopt;
  std::memcpy(matrix.data(), bytes, sizeof(matrix));
  if (!matrix.allFinite() || matrix.isZero(0)) return std::nullopt;
  return matrix;
}

/// A word that this program does not know is undefined.
TwoViewConfig GetConfig(sqlite3_stmt* row, int column) {
  const int64_t config = sqlite3_column_int64(row, column);
  const bool is_known = config >= 0 && config <= static_cast<int64_t>(TwoViewConfig::kMultiple);
  return is_known ? static_cast<TwoViewConfig>(config) : TwoViewConfig::kUndefined;
}

/// The parameters of a SIMPLE_RADIAL camera in a column; empty when they are not those.
std::vector<double> GetSimpleRadial(sqlite3_stmt* row, int column) {
  const void* bytes = sqlite3_column_blob(row, column);
  std::vector<double> params(static_cast<size_t>(CameraModelParameterCount(CameraModel::kSimpleRadial)));
  const size_t size = params.size() * sizeof(double);
  if (bytes == nullptr || sqlite3_column_bytes(row, column) != static_cast<int>(size)) return {};
  std::memcpy(params.data(), bytes, size);
  return params;
}

bool HasColumn(const DatabaseFile& open, const char* table, const char* column) {
  const DatabaseStatement rows(open, "SELECT 1 FROM pragma_table_info(?1) WHERE name = ?2");
  sqlite3_bind_text(rows.get(), 1, table, -1, SQLITE_STATIC);
  sqlite3_bind_text(rows.get(), 2, column, -1, SQLITE_STATIC);
  return rows.Step();
}

void UpdateParams(const DatabaseFile& open, const std::map<uint32_t, std::vector<double>>& params, bool are_known) {
  open.Execute("BEGIN");
  for (const auto& [id, intrinsics] : params) {
    const DatabaseStatement update(
        open, are_known ? "UPDATE cameras SET params = ?1, prior_focal_length = 1 WHERE camera_id = ?2"
                        : "UPDATE cameras SET params = ?1 WHERE camera_id = ?2");
    sqlite3_bind_blob(update.get(), 1, intrinsics.data(), static_cast<int>(intrinsics.size() * sizeof(double)),
                      SQLITE_STATIC);
    sqlite3_bind_int64(update.get(), 2, id);
    update.Step();
  }
  open.Execute("COMMIT");
}

}  // namespace

std::map<std::string, DatabaseImage> ReadDatabaseImages(const fs::path& database) {
  const DatabaseFile open(database);
  const DatabaseStatement rows(open, "SELECT image_id, name, camera_id FROM images");
  std::map<std::string, DatabaseImage> images;
  while (rows.Step()) {
    const auto* name = reinterpret_cast<const char*>(sqlite3_column_text(rows.get(), 1));
    if (name == nullptr) continue;
    images[name] = {static_cast<uint32_t>(sqlite3_column_int64(rows.get(), 0)),
                    static_cast<uint32_t>(sqlite3_column_int64(rows.get(), 2))};
  }
  return images;
}

std::map<uint32_t, int> ReadFeatureCounts(const fs::path& database) {
  const DatabaseFile open(database);
  const DatabaseStatement rows(open,
                               "SELECT images.image_id, keypoints.rows FROM images LEFT JOIN keypoints "
                               "ON images.image_id = keypoints.image_id");
  std::map<uint32_t, int> counts;
  while (rows.Step()) counts[static_cast<uint32_t>(sqlite3_column_int64(rows.get(), 0))] = GetCount(rows.get(), 1);
  return counts;
}

std::vector<MatchedPair> ReadMatchedPairs(const fs::path& database) {
  const DatabaseFile open(database);
  const DatabaseStatement rows(
      open,
      "SELECT matches.pair_id, matches.rows, two_view_geometries.rows, config, H FROM matches LEFT "
      "JOIN two_view_geometries ON matches.pair_id = two_view_geometries.pair_id "
      "ORDER BY matches.pair_id");
  std::vector<MatchedPair> pairs;
  while (rows.Step()) {
    const int64_t id = sqlite3_column_int64(rows.get(), 0);
    MatchedPair pair;
    pair.first = static_cast<uint32_t>(id / kPairBase);
    pair.second = static_cast<uint32_t>(id % kPairBase);
    if (id <= 0 || pair.first >= pair.second || pair.first >= kPairBase) {
      throw RunError("{}: {} is not the number of a pair of images; delete it, colmap makes it anew", database.string(),
                     id);
    }
    pair.matches = GetCount(rows.get(), 1);
    pair.inliers = GetCount(rows.get(), 2);
    pair.config = GetConfig(rows.get(), 3);
    const bool by_homography =
        pair.config >= TwoViewConfig::kPlanar && pair.config <= TwoViewConfig::kPlanarOrPanoramic;
    if (by_homography) pair.homography = GetMatrix(rows.get(), 4);
    pairs.push_back(pair);
  }
  return pairs;
}

std::vector<FeatureMatch> ReadMatches(const fs::path& database, uint32_t first, uint32_t second) {
  const DatabaseFile open(database);
  const DatabaseStatement rows(open, "SELECT rows, data FROM matches WHERE pair_id = ?1");
  sqlite3_bind_int64(rows.get(), 1, PairId(first, second));
  if (!rows.Step()) return {};
  const auto indices = GetList<uint32_t>(rows.get(), 1, GetCount(rows.get(), 0), 2);
  std::vector<FeatureMatch> matches;
  for (size_t i = 0; i < indices.size(); i += 2) matches.push_back({indices[i], indices[i + 1]});
  return matches;
}

int AppendKeypoints(const fs::path& database, uint32_t image_id, const std::vector<Eigen::Vector2f>& keypoints) {
  constexpr int kAffine = 6;  // x, y, and a matrix of 2 x 2
  const DatabaseFile open(database);
  std::vector<float> values;
  int rows = 0, columns = kAffine;
  {
    const DatabaseStatement stored(open, "SELECT rows, cols, data FROM keypoints WHERE image_id = ?1");
    sqlite3_bind_int64(stored.get(), 1, image_id);
    if (stored.Step() && GetCount(stored.get(), 0) > 0) {
      rows = GetCount(stored.get(), 0);
      columns = GetCount(stored.get(), 1);
      values = GetList<float>(stored.get(), 2, rows, columns);
      if (values.empty() || columns < 2) {
        throw RunError("{}: the keypoints of image {} are damaged; delete it, colmap makes it anew", database.string(),
                       image_id);
      }
    }
  }
  for (const Eigen::Vector2f& keypoint : keypoints) {
    const std::array<float, kAffine> shape = {keypoint.x(), keypoint.y(), 1, 0, 0, columns == kAffine ? 1.f : 0.f};
    for (int c = 0; c < columns; ++c) values.push_back(c < kAffine ? shape[static_cast<size_t>(c)] : 0);
  }
  const DatabaseStatement write(
      open, "INSERT OR REPLACE INTO keypoints (image_id, rows, cols, data) VALUES (?1, ?2, ?3, ?4)");
  sqlite3_bind_int64(write.get(), 1, image_id);
  sqlite3_bind_int64(write.get(), 2, rows + static_cast<int64_t>(keypoints.size()));
  sqlite3_bind_int64(write.get(), 3, columns);
  sqlite3_bind_blob64(write.get(), 4, values.data(), values.size() * sizeof(float), SQLITE_STATIC);
  write.Step();
  return rows;
}

void RemoveMatches(const fs::path& database, const std::vector<std::pair<uint32_t, uint32_t>>& pairs) {
  const DatabaseFile open(database);
  open.Execute("BEGIN");
  for (const auto& [a, b] : pairs) {
    for (const char* table : {"matches", "two_view_geometries"}) {
      open.Execute(fmt::format("DELETE FROM {} WHERE pair_id = {}", table, PairId(a, b)).c_str());
    }
  }
  open.Execute("COMMIT");
}

void SetDatabaseCameras(const fs::path& database, const std::map<uint32_t, Intrinsics>& cameras) {
  const DatabaseFile open(database);
  open.Execute("BEGIN");
  for (const auto& [id, intrinsics] : cameras) {
    const DatabaseStatement update(open,
                                   "UPDATE cameras SET model = ?1, width = ?2, height = ?3, params = ?4, "
                                   "prior_focal_length = 1 WHERE camera_id = ?5");
    sqlite3_bind_int(update.get(), 1, static_cast<int>(intrinsics.model));
    sqlite3_bind_int(update.get(), 2, intrinsics.width);
    sqlite3_bind_int(update.get(), 3, intrinsics.height);
    sqlite3_bind_blob(update.get(), 4, intrinsics.params.data(),
                      static_cast<int>(intrinsics.params.size() * sizeof(double)), SQLITE_STATIC);
    sqlite3_bind_int64(update.get(), 5, id);
    update.Step();
  }
  open.Execute("COMMIT");
}

void SetFocalPriors(const fs::path& database, const std::map<std::string, double>& focal_of_image) {
  std::map<uint32_t, double> focal_of_camera;
  for (const auto& [name, image] : ReadDatabaseImages(database)) {
    const auto found = focal_of_image.find(name);
    if (found != focal_of_image.end()) focal_of_camera[image.camera_id] = found->second;
  }
  if (focal_of_camera.empty()) return;
  const DatabaseFile open(database);
  const DatabaseStatement rows(open, "SELECT camera_id, params FROM cameras WHERE model = ?1");
  sqlite3_bind_int(rows.get(), 1, static_cast<int>(CameraModel::kSimpleRadial));
  std::map<uint32_t, std::vector<double>> params;
  while (rows.Step()) {
    const auto id = static_cast<uint32_t>(sqlite3_column_int64(rows.get(), 0));
    std::vector<double> intrinsics = GetSimpleRadial(rows.get(), 1);
    if (intrinsics.empty() || focal_of_camera.count(id) == 0) continue;
    intrinsics[0] = focal_of_camera[id];
    params[id] = std::move(intrinsics);
  }
  UpdateParams(open, params, /*are_known=*/true);
}

int SetFocalGuess(const fs::path& database, double sides) {
  const DatabaseFile open(database);
  const DatabaseStatement rows(
      open, "SELECT camera_id, width, height, params FROM cameras WHERE prior_focal_length = 0 AND model = ?1");
  sqlite3_bind_int(rows.get(), 1, static_cast<int>(CameraModel::kSimpleRadial));
  std::map<uint32_t, std::vector<double>> params;
  while (rows.Step()) {
    std::vector<double> intrinsics = GetSimpleRadial(rows.get(), 3);
    if (intrinsics.empty()) continue;
    intrinsics[0] = sides * std::max(sqlite3_column_int(rows.get(), 1), sqlite3_column_int(rows.get(), 2));
    params[static_cast<uint32_t>(sqlite3_column_int64(rows.get(), 0))] = std::move(intrinsics);
  }
  UpdateParams(open, params, /*are_known=*/false);
  return static_cast<int>(params.size());
}

void NumberImagesByName(const fs::path& database) {
  constexpr int64_t kOutOfTheWay = int64_t{1} << 30;  // colmap allows ids up to 2^31 - 2
  const auto images = ReadDatabaseImages(database);
  struct Numbers {
    const char *table, *column;
    bool is_new = false;  // of COLMAP 4, in which all data are images of cameras
  };
  constexpr Numbers kNumbers[] = {{"images", "image_id"},
                                  {"keypoints", "image_id"},
                                  {"descriptors", "image_id"},
                                  {"frame_data", "data_id", true},
                                  {"pose_priors", "corr_data_id", true}};
  const DatabaseFile open(database);
  open.Execute("BEGIN");
  for (const auto& [table, id, is_new] : kNumbers) {
    if (is_new && !HasColumn(open, table, id)) continue;
    open.Execute(fmt::format("UPDATE {0} SET {1} = {1} + {2}", table, id, kOutOfTheWay).c_str());
    int64_t number = 0;
    for (const auto& [name, image] : images) {
      open.Execute(
          fmt::format("UPDATE {0} SET {1} = {2} WHERE {1} = {3}", table, id, ++number, image.image_id + kOutOfTheWay)
              .c_str());
    }
  }
  if (HasColumn(open, "frame_data", "frame_id")) {  // a frame for each image, which models without frames number alike
    open.Execute(fmt::format("UPDATE frames SET frame_id = frame_id + {0};"
                             "UPDATE frame_data SET frame_id = frame_id + {0};"
                             "UPDATE frames SET frame_id = "
                             "(SELECT data_id FROM frame_data WHERE frame_data.frame_id = frames.frame_id);"
                             "UPDATE frame_data SET frame_id = data_id",
                             kOutOfTheWay)
                     .c_str());
  }
  open.Execute("COMMIT");
}

}  // namespace oraclegs
