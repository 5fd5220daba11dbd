#include <sqlite3.h>

#include <algorithm>

#include "bench/parser_inputs.h"
#include "oraclegs/core/files.h"
#include "oraclegs/image/codecs.h"
#include "oraclegs/propose/proposal_files.h"
#include "oraclegs/scene/colmap_files.h"
#include "oraclegs/scene/read_colmap.h"
#include "oraclegs/scene/transforms.h"
#include "oraclegs/scene/view_list.h"
#include "oraclegs/sfm/colmap_database.h"
#include "oraclegs/sfm/database_file.h"
#include "oraclegs/sfm/matched_features.h"
#include "weights/checkpoint/torch_bytes.h"

namespace oraclegs {
namespace {

namespace fs = std::filesystem;
namespace torch = torch_bytes;

std::string Colmap(uint64_t count) { return torch::Bytes(count, 8); }

}  // namespace

std::vector<ParserInput> SceneInputs() {
  const auto images_text = [](const std::string& file) { ParseImagesText(file, "f"); };
  const auto images_binary = [](const std::string& file) { ParseImagesBinary(file, "f"); };
  const auto transforms = [](const std::string&) { ReadTransformsScene(BenchFolder(), SceneReadOptions{}, Silent()); };
  const auto blender = [](const std::string&) { ReadBlenderScene(BenchFolder(), SceneReadOptions{}, Silent()); };
  const auto frames = [](size_t bytes, bool equal) {
    return R"({"camera_angle_x":1,"w":4,"h":3,"frames":[)" +
           Repeated(bytes,
                    [equal](size_t i) {
                      return (i == 0 ? "" : ",") + std::string(R"({"file_path":"a)") +
                             (equal ? "" : std::to_string(i)) +
                             R"(.png","transform_matrix":[[1,0,0,0],[0,1,0,0],[0,0,1,0],[0,0,0,1]]})";
                    }) +
           "]}";
  };
  const std::string pose(56, '\0');
  return {
      {"colmap text", "points",
       [](size_t bytes) {
         return Repeated(bytes, [](size_t i) { return Numbered("", i + 1, " 1.5 2.5 3.5 200 100 50 0.5 1 7 2 8\n"); });
       },
       [](const std::string& file) { ParsePointsText(file, "f"); }},
      {"colmap text", "one long track",
       [](size_t bytes) { return "1 1 2 3 200 100 50 0.5" + Repeated(bytes, [](size_t) { return " 1 7"; }) + "\n"; },
       [](const std::string& file) { ParsePointsText(file, "f"); }},
      {"colmap text", "many images",
       [](size_t bytes) {
         return Repeated(bytes, [](size_t i) {
           return std::to_string(i + 1) + " 1 0 0 0 1 2 3 1 " + Numbered("a", i, ".jpg\n1 2 3\n");
         });
       },
       images_text},
      {"colmap text", "images of one name",
       [](size_t bytes) {
         return Repeated(bytes, [](size_t i) { return std::to_string(i + 1) + " 1 0 0 0 1 2 3 1 a.jpg\n1 2 3\n"; });
       },
       images_text},
      {"colmap text", "one image of many points",
       [](size_t bytes) {
         return "1 1 0 0 0 1 2 3 1 a.jpg\n" + Repeated(bytes, [](size_t i) { return Numbered("1.5 2.5 ", i, " "); }) +
                "\n";
       },
       images_text},
      {"colmap text", "many cameras",
       [](size_t bytes) {
         return Repeated(bytes, [](size_t i) { return Numbered("", i + 1, " PINHOLE 400 300 500 500 200 150\n"); });
       },
       [](const std::string& file) { ParseCamerasText(file, "f"); }},
      {"colmap binary", "points",
       [](size_t bytes) {
         const size_t n = bytes / 67;
         std::string file = Colmap(n);
         for (size_t i = 0; i < n; ++i) {
           file += torch::Bytes(i + 1, 8) + std::string(24 + 3 + 8, '\0') + Colmap(2) + std::string(16, '\0');
         }
         return file;
       },
       [](const std::string& file) { ParsePointsBinary(file, "f"); }},
      {"colmap binary", "many images",
       [pose](size_t bytes) {
         const size_t n = bytes / 78;
         std::string file = Colmap(n);
         for (size_t i = 0; i < n; ++i) {
           std::string rotated = pose;
           rotated[6] = '\xf0', rotated[7] = '\x3f';  // 1.0
           file += torch::Bytes(i + 1, 4) + rotated + torch::Bytes(1, 4) + Numbered("a", i, "") + '\0' + Colmap(0);
         }
         return file;
       },
       images_binary},
      {"colmap binary", "one long name",
       [pose](size_t bytes) {
         return Colmap(1) + torch::Bytes(1, 4) + pose + torch::Bytes(1, 4) + std::string(bytes, 'a');
       },
       images_binary},
      {"transforms", "many frames", [frames](size_t bytes) { return frames(bytes, false); }, transforms,
       "transforms.json"},
      {"transforms", "frames of one image", [frames](size_t bytes) { return frames(bytes, true); }, transforms,
       "transforms.json"},
      {"blender", "many frames", [frames](size_t bytes) { return frames(bytes, false); }, blender,
       "transforms_train.json"},
      {"colmap scene", "one image of many points",
       [](size_t bytes) {
         WritePng(BenchFolder() / "images" / "a.png", {4, 3, 3, std::vector<uint8_t>(36, 128)});
         ReplaceFile(BenchFolder() / "cameras.txt", "1 PINHOLE 4 3 4 4 2 1.5\n");
         ReplaceFile(BenchFolder() / "images.txt", "1 1 0 0 0 0 0 0 1 a.png\n\n");
         return Repeated(bytes, [](size_t i) { return Numbered("", i + 1, " 1.5 2.5 3.5 200 100 50 0.5 1 7 1 8\n"); });
       },
       [](const std::string&) { ReadColmapScene(BenchFolder(), BenchFolder() / "images", Silent()); }, "points3D.txt"},
      {"colmap database", "images and pairs",
       [](size_t bytes) {
         std::string sql =
             "PRAGMA journal_mode = OFF; PRAGMA synchronous = OFF;"
             "CREATE TABLE images (image_id INTEGER PRIMARY KEY, name, camera_id);"
             "CREATE TABLE keypoints (image_id INTEGER PRIMARY KEY, rows, cols, data);"
             "CREATE TABLE matches (pair_id INTEGER PRIMARY KEY, rows, cols, data);"
             "CREATE TABLE two_view_geometries (pair_id INTEGER PRIMARY KEY, rows, cols, data, config, F, E, H);"
             "BEGIN;";
         const auto images = static_cast<uint32_t>(bytes / 260 + 2);
         for (uint32_t i = 1; i <= images; ++i) {
           const std::string id = std::to_string(i);
           sql += "INSERT INTO images VALUES (" + id + ", 'a" + id + ".jpg', 1);";
           sql += "INSERT INTO keypoints VALUES (" + id + ", 1, 4, zeroblob(16));";
           if (i == images) break;
           const std::string pair = std::to_string(PairId(i, i + 1)) + ", 4, 2, zeroblob(32)";
           sql += "INSERT INTO matches VALUES (" + pair + ");";
           sql += "INSERT INTO two_view_geometries VALUES (" + pair + ", 3, NULL, NULL, NULL);";
         }
         const fs::path path = BenchFolder() / "made.db";
         fs::remove(path);
         sqlite3* database = nullptr;
         sqlite3_open(path.c_str(), &database);
         sqlite3_exec(database, (sql + "COMMIT").c_str(), nullptr, nullptr, nullptr);
         sqlite3_close(database);
         return ReadFile(path);
       },
       [](const std::string&) {
         ReadFeatureCounts(BenchFolder() / "a.db");
         ReadMatchedPairs(BenchFolder() / "a.db");
         ReadVerifiedMatches(BenchFolder() / "a.db");
       },
       "a.db"},
      {"list of views", "a file of names",
       [](size_t bytes) {
         return Repeated(std::min<size_t>(bytes, 1000000), [](size_t i) { return Numbered("a", i, "\n"); });
       },
       [](const std::string&) { ExpandViewList("@" + (BenchFolder() / "list.txt").string(), "train"); }, "list.txt"},
      {"list of views", "names of a scene",
       [](size_t bytes) {
         return Repeated(std::min<size_t>(bytes, 1000000), [](size_t i) { return Numbered("a", i, ","); }) + "a0";
       },
       [](const std::string& file) {
         Scene scene;
         scene.root = "f";
         for (size_t i = 0; i < file.size() / 8; ++i) {
           scene.views.emplace_back();
           scene.views.back().name = scene.views.back().image_path = Numbered("a", i, ".jpg");
         }
         NamedViews(scene, "--train-views", file);
       }},
      {"proposals", "many targets",
       [](size_t bytes) {
         return R"({"fl_x":4,"fl_y":4,"cx":2,"cy":1.5,"w":4,"h":3,"frames":[)" +
                Repeated(bytes,
                         [](size_t i) {
                           return (i == 0 ? "" : ",") + std::string(R"({"file_path":"a)") + std::to_string(i) +
                                  R"(.png","transform_matrix":[[1,0,0,0],[0,1,0,0],[0,0,1,0],[0,0,0,1]]})";
                         }) +
                "]}";
       },
       [](const std::string&) { ReadTargets(BenchFolder()); }, "transforms.json"},
  };
}

}  // namespace oraclegs
