#include "oraclegs/sfm/mapper_attempts.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <sqlite3.h>

#include <algorithm>
#include <cstdlib>
#include <stdexcept>
#include <string>
#include <vector>

#include "oraclegs/core/error.h"
#include "oraclegs/core/files.h"
#include "oraclegs/image/codecs.h"
#include "oraclegs/scene/colmap_files.h"
#include "oraclegs/scene/colmap_model.h"
#include "oraclegs/scene/read_colmap.h"
#include "oraclegs/sfm/colmap_runner.h"
#include "scene/tiny_scenes.h"
#include "support/errors.h"
#include "support/event_recorder.h"
#include "support/temp_dir.h"

namespace oraclegs {
namespace {

namespace fs = std::filesystem;
using testing::ElementsAre;
using testing::HasSubstr;

const std::vector<std::string> kNames{"camera0/0.png", "camera0/1.png", "camera0/2.png"};

/// A model of the first `images` views, side by side before `points` points. The third has a camera of its own.
/// The third image sees `share` of the points.
void WriteModel(const fs::path& dir, int images, int points, double focal_of_third = 90, double share = 1) {
  std::vector<ColmapImage> views;
  std::string track;
  for (int i = 0; i < images; ++i) {
    ColmapImage image{static_cast<uint32_t>(i + 1), kNames[static_cast<size_t>(i)], i == 2 ? 2u : 1u};
    image.cam_from_world.translation() = Eigen::Vector3d(-.5 * i, 0, 0);
    views.push_back(image);
    track += fmt::format(" {} 0", i + 1);
  }
  const auto camera = [](double focal) { return Intrinsics{CameraModel::kSimpleRadial, 100, 80, {focal, 50, 40, 0}}; };
  WriteColmapText(dir, {{1, camera(90)}, {2, camera(focal_of_third)}}, views);
  std::string text;
  for (int i = 0; i < points; ++i) {
    text += fmt::format("{} 0.{} 0 5 9 9 9 0.5{}\n", i + 1, i % 10, i < share * points ? track : " 1 0 2 0");
  }
  WriteText(dir / "points3D.txt", text);
}

/// `inliers` of 100 matches for each pair of images.
void WriteDatabase(const fs::path& path, int inliers) {
  sqlite3* database = nullptr;
  ASSERT_EQ(sqlite3_open(path.c_str(), &database), SQLITE_OK);
  std::string sql =
      "CREATE TABLE cameras (camera_id INTEGER PRIMARY KEY, model INTEGER, width INTEGER, height INTEGER, params BLOB, "
      "prior_focal_length INTEGER); CREATE TABLE images (image_id INTEGER PRIMARY KEY, name TEXT, camera_id INTEGER);"
      "CREATE TABLE keypoints (image_id INTEGER PRIMARY KEY, rows INTEGER, cols INTEGER, data BLOB);"
      "CREATE TABLE descriptors (image_id INTEGER PRIMARY KEY);"
      "CREATE TABLE matches (pair_id INTEGER PRIMARY KEY, rows INTEGER, data BLOB);"
      "CREATE TABLE two_view_geometries (pair_id INTEGER PRIMARY KEY, rows INTEGER, config INTEGER, H BLOB);"
      "INSERT INTO cameras VALUES (1, 2, 100, 80, zeroblob(32), 0);";
  for (size_t i = 0; i < kNames.size(); ++i) {
    sql += fmt::format(
        "INSERT INTO images VALUES ({0}, '{1}', 1); INSERT INTO keypoints VALUES ({0}, 900, 2, zeroblob(7200));"
        "INSERT INTO descriptors VALUES ({0});",
        i + 1, kNames[i]);
  }
  for (const auto& [a, b] : {std::pair(1, 2), std::pair(1, 3), std::pair(2, 3)}) {
    const int64_t id = int64_t{2147483647} * a + b;
    sql += fmt::format(
        "INSERT INTO matches VALUES ({0}, 100, NULL); INSERT INTO two_view_geometries VALUES ({0}, {1}, 3, NULL);", id,
        inliers);
  }
  EXPECT_EQ(sqlite3_exec(database, sql.c_str(), nullptr, nullptr, nullptr), SQLITE_OK) << sqlite3_errmsg(database);
  sqlite3_close(database);
}

/// A shell script in colmap's place. It notes its commands; `mapper` is its body for the n-th run of the mapper ($n),
/// `rest` decides other commands; both may call `give MODEL`, which copies a folder of models to the --output_path.
class FakeMapper {
 public:
  FakeMapper(const std::string& mapper, const std::string& rest, int inliers = 60) : old_path_(std::getenv("PATH")) {
    WriteModel(dir_ / "models" / "two", 2, 40);
    WriteModel(dir_ / "models" / "rich", 2, 90);
    WriteModel(dir_ / "models" / "three", 3, 60);
    WriteModel(dir_ / "models" / "hollow", 3, 5);
    WriteModel(dir_ / "models" / "odd", 3, 60, 5000);
    WriteModel(dir_ / "models" / "loose", 3, 60, 90, .2);
    WriteDatabase(dir_ / "fresh.db", inliers);
    WriteText(dir_ / "colmap", fmt::format("#!/bin/sh\n"
                                           "here='{}'\n"
                                           "echo \"$1\" >> \"$here/commands\"\n"
                                           "command=$1 database=$3\n"
                                           "while [ $# -gt 0 ]; do [ \"$1\" = --output_path ] && out=$2; shift; done\n"
                                           "give() {{ mkdir -p \"$out$2\" && cp \"$here/models/$1/\"* \"$out$2/\"; }}\n"
                                           "case $command in\n"
                                           "feature_extractor) cp \"$here/fresh.db\" \"$database\";;\n"
                                           "mapper) n=$(grep -c mapper \"$here/commands\"); {};;\n"
                                           "{}\n"
                                           "esac\n",
                                           dir_.path().string(), mapper, rest));
    fs::permissions(dir_ / "colmap", fs::perms::owner_all);
    setenv("PATH", (dir_.path().string() + ":" + old_path_).c_str(), 1);
  }
  ~FakeMapper() { setenv("PATH", old_path_.c_str(), 1); }
  FakeMapper(const FakeMapper&) = delete;
  FakeMapper& operator=(const FakeMapper&) = delete;

  std::vector<std::string> Commands() const {
    std::vector<std::string> lines;
    const std::string text = ReadFile(dir_ / "commands");
    for (size_t at = 0, end; (end = text.find('\n', at)) != std::string::npos; at = end + 1) {
      lines.push_back(text.substr(at, end - at));
    }
    return lines;
  }
  long Count(const std::string& command) const {
    const auto commands = Commands();
    return std::count(commands.begin(), commands.end(), command);
  }

 private:
  TempDir dir_;
  std::string old_path_;
};

std::vector<std::string> FilesIn(const fs::path& dir) {
  std::vector<std::string> names;
  for (const auto& entry : fs::directory_iterator(dir)) names.push_back(entry.path().filename().string());
  std::sort(names.begin(), names.end());
  return names;
}

TEST(RunAttempts, StopsWhenTheFirstAttemptHasAll) {
  const TempDir dir;
  const FakeMapper fake("give three /0", "");
  const AttemptResult result = RunAttempts({kNames, false, dir.path()}, Silent());
  EXPECT_THAT(fake.Commands(), ElementsAre("feature_extractor", "exhaustive_matcher", "mapper"));
  EXPECT_EQ(result.best.registered(), 3);
  ASSERT_EQ(result.attempts.size(), 1u);
  EXPECT_EQ(result.attempts[0].name, "strict");
  EXPECT_TRUE(result.attempts[0].kept);
  EXPECT_THAT(FilesIn(dir.path()), ElementsAre("colmap.log", "database.db", "sparse"));
  EXPECT_EQ(ReadColmapImages(dir / "sparse" / "0").size(), 3u);
}

TEST(RunAttempts, RepeatsOnlyWhatCrashed) {
  const TempDir dir;
  {
    const FakeMapper fake("case $n in 2) kill -SEGV $$;; *) exit 1;; esac", "");
    EXPECT_THAT(MessageOf<RunError>([&] {
                  RunAttempts({kNames, false, dir.path()}, Silent());
                }),
                AllOf(HasSubstr("colmap mapper crashed (signal 11)"), HasSubstr("run the same command again")));
  }
  const FakeMapper fake("give three /0", "");
  EXPECT_EQ(RunAttempts({kNames, false, dir.path()}, Silent()).best.registered(), 3);
  EXPECT_THAT(fake.Commands(), ElementsAre("mapper")) << "the others are finished";
}

TEST(RunAttempts, PassesOverACrashWhereAModelIsFound) {
  const TempDir dir;
  const FakeMapper fake("case $n in 1) kill -SEGV $$;; *) give three /0;; esac", "");
  EXPECT_EQ(RunAttempts({kNames, false, dir.path()}, Silent()).best.registered(), 3);
}

TEST(RunAttempts, DiscardsAnUnsoundModel) {
  const TempDir dir;
  const FakeMapper fake("case $n in 1) give two /0;; 2) give hollow /0; give rich /1;; esac", "");
  const AttemptResult result = RunAttempts({kNames, false, dir.path()}, Silent());
  EXPECT_EQ(result.best.registered(), 2);
  EXPECT_EQ(result.best.points, 90) << "of two models of two images that with more points";
  EXPECT_EQ(ReadColmapPoints(dir / "sparse" / "0").size(), 90u);
  ASSERT_GE(result.attempts.size(), 2u);
  EXPECT_EQ(result.attempts[1].name, "relaxed");
  EXPECT_TRUE(result.attempts[1].kept);
  for (size_t i = 0; i < result.attempts.size(); ++i) EXPECT_EQ(result.attempts[i].kept, i == 1) << i;
  EXPECT_EQ(fake.Count("feature_extractor"), 5) << "one image is missing: every set of features is tried";
  EXPECT_EQ(fake.Count("matches_importer"), 1) << "the pairs of the missing one, once its intrinsics are known";
  EXPECT_THAT(FilesIn(dir.path()), ElementsAre("colmap.log", "database.db", "sparse"));
}

TEST(RunAttempts, RegistersRemainingImages) {
  const TempDir dir;
  const FakeMapper fake("give two /0", "image_registrator|point_triangulator|bundle_adjuster) give three ;;");
  const AttemptResult result = RunAttempts({kNames, false, dir.path()}, Silent());
  EXPECT_EQ(result.best.registered(), 3);
  EXPECT_EQ(result.attempts.back().name, "remaining images");
  EXPECT_TRUE(result.attempts.back().kept);
  EXPECT_EQ(fake.Count("feature_extractor"), 1);
  EXPECT_EQ(fake.Commands().back(), "bundle_adjuster");
}

TEST(RunAttempts, KeepsTheModelWhenContinuingFails) {
  const TempDir dir;
  const FakeMapper fake("[ $n = 1 ] && give two /0", "image_registrator) give three ;; point_triangulator) exit 1;;");
  const AttemptResult result = RunAttempts({kNames, false, dir.path()}, Silent());
  EXPECT_EQ(result.best.registered(), 2);
  EXPECT_EQ(ReadColmapImages(dir / "sparse" / "0").size(), 2u);
}

TEST(RunAttempts, KeepsTheFirstDatabaseWithoutAModel) {
  const TempDir dir;
  const FakeMapper fake("exit 1", "");
  EventRecorder events;
  const AttemptResult result = RunAttempts({kNames, false, dir.path()}, events.AsListener());
  EXPECT_EQ(result.best.registered(), 0);
  EXPECT_EQ(fake.Count("feature_extractor"), 5);
  EXPECT_THAT(events.notes,
              testing::Contains(HasSubstr("0 of 3 photos are registered; trying again with more features")));
  EXPECT_THAT(FilesIn(dir.path()), ElementsAre("colmap.log", "database.db"));
}

TEST(RunAttempts, KeepsTheDatabaseOfTheBestModel) {
  const TempDir dir;
  // Only the fifth run of the mapper, the first with other features, finds anything.
  const FakeMapper fake("[ $n = 5 ] && give three /0", "");
  const AttemptResult result = RunAttempts({kNames, false, dir.path()}, Silent());
  EXPECT_EQ(result.best.registered(), 3);
  EXPECT_EQ(result.attempts.back().features, "coarse features");
  EXPECT_EQ(fake.Count("feature_extractor"), 2);
  EXPECT_THAT(FilesIn(dir.path()), ElementsAre("colmap.log", "database.db", "sparse"));
}

/// One keypoint an image, at (1, 2), that matches in all.
LearnedFeatures FindOne(const ImageF&) { return {{Eigen::Vector2f(1, 2)}, Buffer<float>::From({1, 2}, {0.6f, 0.8f})}; }

void WritePhotos(const fs::path& work_dir) {
  for (const std::string& name : kNames) {
    fs::create_directories((work_dir / "images" / name).parent_path());
    WritePng(work_dir / "images" / name, Image8{4, 4, 3, std::vector<uint8_t>(48, 7)});
  }
}

TEST(RunAttempts, AddsLearnedFeaturesWhereOthersLeavePhotosOut) {
  const TempDir dir;
  WritePhotos(dir.path());
  const FakeMapper fake("case $n in 1) give two /0;; 5) give three /0;; *) exit 1;; esac",
                        "matches_importer) cp \"$here/fresh.db\" \"$database\";;");
  AttemptRequest request{kNames, false, dir.path()};
  request.find_features = FindOne;
  EventRecorder events;
  const AttemptResult result = RunAttempts(request, events.AsListener());
  EXPECT_EQ(result.best.registered(), 3);
  EXPECT_EQ(result.attempts.back().features, "learned features");
  EXPECT_EQ(fake.Count("feature_extractor"), 1);
  EXPECT_EQ(fake.Count("matches_importer"), 1);
  EXPECT_THAT(events.notes,
              testing::Contains(HasSubstr("2 of 3 photos are registered; trying again with learned features")));
}

TEST(RunAttempts, AsksForNoLearnedFeaturesWhereAllPhotosRegister) {
  const TempDir dir;
  const FakeMapper fake("give three /0", "");
  AttemptRequest request{kNames, false, dir.path()};
  request.find_features = [](const ImageF&) -> LearnedFeatures { throw std::logic_error("it was asked"); };
  EXPECT_EQ(RunAttempts(request, Silent()).best.registered(), 3);
}

TEST(RunAttempts, EndsSoonWhenNothingMatches) {
  const TempDir dir;
  const FakeMapper fake("exit 1", "", 0);
  EXPECT_EQ(RunAttempts({kNames, false, dir.path()}, Silent()).best.registered(), 0);
  EXPECT_THAT(fake.Commands(),
              ElementsAre("feature_extractor", "exhaustive_matcher", "feature_extractor", "exhaustive_matcher"))
      << "the usual features, and the coarse ones that would show whether anything matches";
}

TEST(RunAttempts, TriesNoMoreFeaturesForMatchesOfChance) {
  const TempDir dir;
  const FakeMapper fake("exit 1", "", 19);
  RunAttempts({kNames, false, dir.path()}, Silent());
  EXPECT_EQ(fake.Count("feature_extractor"), 2);
}

TEST(RunAttempts, LeavesOutAnImplausibleCamera) {
  const TempDir dir;
  const FakeMapper fake("give odd /0", "image_deleter) give two ;; bundle_adjuster) give rich ;;");
  const AttemptResult result = RunAttempts({kNames, false, dir.path()}, Silent());
  EXPECT_EQ(result.best.registered(), 2);
  EXPECT_EQ(result.best.points, 90) << "what is left is adjusted anew";
  EXPECT_TRUE(result.best.plausible_intrinsics);
  EXPECT_TRUE(result.attempts[0].kept);
  EXPECT_EQ(result.left_out, std::vector<std::string>{kNames[2]});
}

TEST(RunAttempts, LeavesOutWhatNoDepthConfirms) {
  for (const bool is_loose : {false, true}) {
    const TempDir dir;
    WritePhotos(dir.path());
    const FakeMapper fake(is_loose ? "give loose /0" : "give three /0",
                          "image_deleter) give two ;; bundle_adjuster) give two ;;");
    AttemptRequest request{kNames, false, dir.path()};
    request.confirmed_shares = [](const Scene& model) {
      EXPECT_EQ(model.views.size(), 3u);
      return std::vector<double>{.5, .6, .02};
    };
    const AttemptResult result = RunAttempts(request, Silent());
    EXPECT_EQ(result.best.registered(), is_loose ? 2 : 3) << "what hangs on many points needs no proof";
    EXPECT_EQ(result.left_out, is_loose ? std::vector<std::string>{kNames[2]} : std::vector<std::string>());
    EXPECT_TRUE(result.attempts.back().kept);
  }
}

TEST(RunAttempts, EndsWhereCostlyFeaturesAddNothing) {
  const TempDir dir;
  const FakeMapper fake("give two /0", "");
  std::vector<std::string> names = kNames;
  for (int i = 3; i <= kMaxImagesForAllFeatures; ++i) names.push_back(fmt::format("camera0/{}.png", i));
  const AttemptResult result = RunAttempts({names, false, dir.path()}, Silent());
  EXPECT_EQ(result.best.registered(), 2);
  EXPECT_EQ(fake.Count("feature_extractor"), 3) << "usual, coarse and more features";
  EXPECT_EQ(fake.Count("matches_importer"), 0);
}

TEST(RunAttempts, GoesOnWhereAnEarlierCallEnded) {
  const TempDir dir;
  {
    const FakeMapper fake("", "exhaustive_matcher) exit 7;;");
    EXPECT_THROW(RunAttempts({kNames, false, dir.path()}, Silent()), ColmapFailure);
  }
  {
    const FakeMapper fake("[ $n = 1 ] && give two /0", "");
    const Listener stop = [](const Event& event) {
      const auto* note = std::get_if<Note>(&event);
      if (note != nullptr && note->text.find("coarse features") != std::string::npos) throw Interrupted("stopped");
    };
    EXPECT_THROW(RunAttempts({kNames, false, dir.path()}, stop), Interrupted);
    EXPECT_EQ(fake.Commands()[0], "exhaustive_matcher") << "the features stand";
  }
  const FakeMapper fake("exit 1", "");
  const AttemptResult result = RunAttempts({kNames, false, dir.path()}, Silent());
  EXPECT_EQ(result.best.registered(), 2);
  EXPECT_EQ(result.attempts[0].name, "strict");
  EXPECT_TRUE(result.attempts[0].kept);
  EXPECT_EQ(fake.Count("feature_extractor"), 4) << "the first set is not tried again";
  EXPECT_EQ(ReadColmapImages(dir / "sparse" / "0").size(), 2u);
}

TEST(RunAttempts, ThrowsWhenTheFirstFeaturesFail) {
  const TempDir dir;
  const FakeMapper fake("", "exhaustive_matcher) exit 7;;");
  try {
    RunAttempts({kNames, false, dir.path()}, Silent());
    ADD_FAILURE() << "no ColmapFailure was thrown";
  } catch (const ColmapFailure& failure) {
    EXPECT_EQ(failure.command, "exhaustive_matcher");
    EXPECT_EQ(failure.exit_code, 7);
  }
}

}  // namespace
}  // namespace oraclegs
