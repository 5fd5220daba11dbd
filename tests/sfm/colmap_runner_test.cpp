#include "oraclegs/sfm/colmap_runner.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <sqlite3.h>

#include <cstdlib>
#include <string>
#include <vector>

#include "oraclegs/core/error.h"
#include "oraclegs/core/files.h"
#include "oraclegs/core/interrupt.h"
#include "oraclegs/core/parallel.h"
#include "oraclegs/sfm/colmap_database.h"
#include "oraclegs/sfm/register_views.h"
#include "scene/tiny_scenes.h"
#include "support/temp_dir.h"
#include "support/textured_planes.h"

namespace oraclegs {
namespace {

namespace fs = std::filesystem;
using testing::AllOf;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::StartsWith;

/// A shell script that stands before the real colmap in PATH. It notes its arguments, one a line, and runs `body`.
class FakeColmap {
 public:
  explicit FakeColmap(const std::string& body) : old_path_(std::getenv("PATH")) {
    const fs::path program = dir_ / "colmap";
    WriteText(program, "#!/bin/sh\nprintf '%s\\n' \"$@\" >> '" + (dir_ / "arguments").string() + "'\n" + body + "\n");
    fs::permissions(program, fs::perms::owner_all);
    setenv("PATH", (dir_.path().string() + ":" + old_path_).c_str(), 1);
  }
  ~FakeColmap() { setenv("PATH", old_path_.c_str(), 1); }
  FakeColmap(const FakeColmap&) = delete;
  FakeColmap& operator=(const FakeColmap&) = delete;

  std::vector<std::string> Arguments() const {
    std::vector<std::string> lines;
    const std::string text = ReadFile(dir_ / "arguments");
    for (size_t at = 0, end; (end = text.find('\n', at)) != std::string::npos; at = end + 1) {
      lines.push_back(text.substr(at, end - at));
    }
    return lines;
  }

 private:
  TempDir dir_;
  std::string old_path_;
};

/// The reported steps, as "stage done/total unit, detail".
struct Steps {
  std::vector<std::string> reported;
  Listener listener = [this](const Event& event) {
    const auto* step = std::get_if<StepDone>(&event);
    if (step == nullptr) {
      ADD_FAILURE() << "an event of another kind";
      return;
    }
    reported.push_back(fmt::format("{} {}/{} {}, {}", step->stage, step->done, step->total, step->unit, step->detail));
  };
};

ColmapFailure FailureOf(const ColmapRunner& colmap) {
  try {
    colmap.Run("mapper", {}, "registering");
  } catch (const ColmapFailure& failure) {
    return failure;
  }
  ADD_FAILURE() << "no ColmapFailure was thrown";
  return {};
}

void WriteTwoImages(const fs::path& path) {
  sqlite3* database = nullptr;
  ASSERT_EQ(sqlite3_open(path.c_str(), &database), SQLITE_OK);
  EXPECT_EQ(sqlite3_exec(database,
                         "CREATE TABLE images (image_id INTEGER PRIMARY KEY, name TEXT, camera_id INTEGER);"
                         "CREATE TABLE keypoints (image_id INTEGER PRIMARY KEY);"
                         "CREATE TABLE descriptors (image_id INTEGER PRIMARY KEY);"
                         "INSERT INTO images VALUES (1, 'b.png', 1), (2, 'a.png', 1);",
                         nullptr, nullptr, nullptr),
            SQLITE_OK);
  sqlite3_close(database);
}

TEST(ColmapRunner, PassesOptionsWithoutAShell) {
  const TempDir dir;
  const FakeColmap fake("");
  const Listener silent = Silent();
  const ColmapRunner colmap(dir.path(), silent, "sfm");
  colmap.Run("mapper", {{"output_path", "a b; $(touch x) *"}, {"Mapper.min_model_size", "2"}, {"empty", ""}}, "");
  EXPECT_THAT(fake.Arguments(),
              ElementsAre("mapper", "--database_path", (dir / "database.db").string(), "--Mapper.min_model_size", "2",
                          "--empty", "", "--output_path", "a b; $(touch x) *"));
}

TEST(ColmapRunner, ReportsColmapsProgress) {
  const TempDir dir;
  const FakeColmap fake(R"(cat <<'END'
==============================================================================
Feature extraction
Processed file [1/12]
  Name:            Processed file [9/12]
Processed file [x/12]
Processed file [12/12]
END
echo 'Matching block [1/2, 2/2] in 0.250s'
echo 'Registering image #7 (4)' >&2
echo 'Triangulating image #3'
printf 'Registering image #9 (5)')");
  const Steps steps;
  ColmapRunner(dir.path(), steps.listener, "sfm").Run("feature_extractor", {}, "working");
  EXPECT_THAT(steps.reported,
              ElementsAre("sfm 1/12 images, working", "sfm 12/12 images, working", "sfm 1/0 images, working",
                          "sfm 2/0 images, working", "sfm 3/0 images, working"));
}

TEST(ColmapRunner, ReportsTheProgressOfNewerVersions) {
  const TempDir dir;
  const FakeColmap fake(R"(cat <<'END'
I20261128 13:20:01.123456 4711 feature_extraction.cc:271] Processed file [1/12]
I20261128 13:20:02.123456 4711 incremental_pipeline.cc:607] Registering image #3 (num_reg_frames=2)
END)");
  const Steps steps;
  ColmapRunner(dir.path(), steps.listener, "sfm").Run("feature_extractor", {}, "working");
  EXPECT_THAT(steps.reported, ElementsAre("sfm 1/12 images, working", "sfm 1/0 images, working"));
}

TEST(ColmapRunner, AsksNewerVersionsByTheirNamesOfOptions) {
  const TempDir dir;
  const FakeColmap fake(R"(case "$*" in
*--SiftMatching.use_gpu*)
  printf "\\033[0;31mE20261128 13:20:01.1 4711 manager.cc:265] Failed to parse - unknown option '--SiftMatching.use_gpu'.\\n\\033[m" >&2
  exit 1;;
esac)");
  const Listener silent = Silent();
  const ColmapRunner colmap(dir.path(), silent, "sfm");
  const ColmapOptions options{{"SiftMatching.use_gpu", "0"}, {"SiftMatching.max_ratio", "0.8"}};
  colmap.Run("matcher", options, "matching");
  colmap.Run("matcher", options, "matching again");
  const std::string database = (dir / "database.db").string();
  EXPECT_THAT(fake.Arguments(), ElementsAre("matcher", "--database_path", database, "--SiftMatching.max_ratio", "0.8",
                                            "--SiftMatching.use_gpu", "0",  //
                                            "matcher", "--database_path", database, "--SiftMatching.max_ratio", "0.8",
                                            "--FeatureMatching.use_gpu", "0",  //
                                            "matcher", "--database_path", database, "--SiftMatching.max_ratio", "0.8",
                                            "--FeatureMatching.use_gpu", "0"))
      << "one that was refused is not tried again";
}

TEST(ColmapRunner, CountsEachCommandFromOne) {
  const TempDir dir;
  const FakeColmap fake("echo 'Registering image #5 (1)'; echo \"$1 was here\" >&2");
  const Steps steps;
  const ColmapRunner colmap(dir.path(), steps.listener, "sfm");
  colmap.Run("mapper", {}, "first");
  colmap.Run("point_triangulator", {}, "second");
  EXPECT_THAT(steps.reported, ElementsAre("sfm 1/0 images, first", "sfm 1/0 images, second"));
  EXPECT_EQ(ReadFile(dir / "colmap.log"),
            "Registering image #5 (1)\nmapper was here\nRegistering image #5 (1)\npoint_triangulator was here\n");
}

TEST(ColmapRunner, ReportsTheLastReadableLineOfAFailure) {
  const TempDir dir;
  const FakeColmap fake("echo started; echo 'ERROR: no good initial image pair' >&2; printf '\\n \\t\\n'; exit 1");
  const Listener silent = Silent();
  const ColmapFailure failure = FailureOf(ColmapRunner(dir.path(), silent, "sfm"));
  EXPECT_EQ(failure.command, "mapper");
  EXPECT_EQ(failure.exit_code, 1);
  EXPECT_EQ(failure.last_line, "ERROR: no good initial image pair");
  EXPECT_EQ(ReadFile(dir / "colmap.log"), "started\nERROR: no good initial image pair\n\n \t\n");
}

TEST(ColmapRunner, ReportsTheCauseOfACrash) {
  const TempDir dir;
  const FakeColmap fake(
      "echo 'F20261122 08:06:59.932825 11264 sfm.cc:473] Check failed: bundle_adjuster.Solve(&reconstruction) ';"
      "echo '*** Check failure stack trace: ***'; echo '    @     0x562d91bf63a1  _start'; exit 134");
  const Listener silent = Silent();
  const ColmapFailure failure = FailureOf(ColmapRunner(dir.path(), silent, "sfm"));
  EXPECT_EQ(failure.last_line, "Check failed: bundle_adjuster.Solve(&reconstruction) ");
  EXPECT_EQ(failure.exit_code, 134);
}

TEST(ColmapRunner, FailsOnACrashAndAMissingProgram) {
  const TempDir dir;
  const Listener silent = Silent();
  {
    const FakeColmap fake("echo almost; kill -SEGV $$");
    const ColmapFailure failure = FailureOf(ColmapRunner(dir.path(), silent, "sfm"));
    EXPECT_EQ(failure.exit_code, 128 + SIGSEGV);
    EXPECT_EQ(failure.Text(), fmt::format("colmap {} crashed (signal 11): almost", failure.command));
  }
  const FakeColmap restores_path("");
  setenv("PATH", "/nowhere", 1);
  const ColmapFailure failure = FailureOf(ColmapRunner(dir.path(), silent, "sfm"));
  EXPECT_EQ(failure.exit_code, 127);
  EXPECT_THAT(failure.last_line, StartsWith("cannot start colmap: "));
}

/// The error of a run that may succeed when repeated.
std::string PassingErrorOf(const TempDir& dir) {
  const Listener silent = Silent();
  try {
    ColmapRunner(dir.path(), silent, "sfm").Run("mapper", {}, "");
  } catch (const RunError& error) {
    return error.what();
  }
  ADD_FAILURE() << "no RunError was thrown";
  return "";
}

TEST(ColmapRunner, TellsWhatPassesFromWhatFailsAgain) {
  const TempDir dir;
  const std::string log = (dir / "colmap.log").string();
  {
    const FakeColmap fake("echo almost; kill -KILL $$");
    EXPECT_EQ(PassingErrorOf(dir),
              "colmap mapper was killed from outside, as happens when memory runs out; run the same command again (it "
              "said last: almost); see " +
                  log);
  }
  {
    const FakeColmap fake("echo 'SQLite error: database or disk is full'; kill -ABRT $$");
    EXPECT_THAT(PassingErrorOf(dir), HasSubstr("no space left on the disk; make room"));
  }
  {
    const FakeColmap fake("echo 'SQLite error: disk I/O error'; exit 1");
    EXPECT_THAT(PassingErrorOf(dir), HasSubstr("could not write to the disk; check it, and make room there"));
  }
  {
    const FakeColmap fake("echo \"terminate called after throwing 'std::bad_alloc'\" >&2; kill -ABRT $$");
    EXPECT_THAT(PassingErrorOf(dir), HasSubstr("ran out of memory; close other programs"));
  }
  setenv("ORACLEGS_STALL_LIMIT", "0.3", 1);
  const FakeColmap fake("echo 'all is well'; sleep 60");
  EXPECT_THAT(PassingErrorOf(dir),
              AllOf(HasSubstr("did nothing for 0.3 s"), HasSubstr("it said last: all is well"), HasSubstr(log)));
  unsetenv("ORACLEGS_STALL_LIMIT");
}

TEST(ColmapRunner, StartsOnceMoreWhatDoesNothing) {
  const TempDir dir;
  const std::string first = (dir / "first").string();
  const FakeColmap fake(fmt::format("if [ ! -e {0} ]; then touch {0}; sleep 60; fi; echo done", first));
  setenv("ORACLEGS_STALL_LIMIT", "0.3", 1);
  std::vector<std::string> warnings;
  const Listener listener = [&](const Event& event) {
    if (const auto* warning = std::get_if<Warning>(&event)) warnings.push_back(warning->text);
  };
  EXPECT_NO_THROW(ColmapRunner(dir.path(), listener, "sfm").Run("feature_extractor", {}, ""));
  unsetenv("ORACLEGS_STALL_LIMIT");
  EXPECT_THAT(warnings, ElementsAre("colmap feature_extractor did nothing for 0.3 s and was ended; it is started once "
                                    "more"));
  EXPECT_EQ(ReadFile(dir / "colmap.log"), "done\n");
}

TEST(ColmapRunner, LogsToItsLogAlone) {
  const TempDir dir;
  const FakeColmap fake("echo \"logtostderr is $GLOG_logtostderr, files go to $GLOG_log_dir\"");
  const Listener silent = Silent();
  ColmapRunner(dir.path(), silent, "sfm").Run("mapper", {}, "");
  EXPECT_EQ(ReadFile(dir / "colmap.log"),
            fmt::format("logtostderr is 1, files go to {}\n", (dir / "attempts").string()));
}

TEST(ColmapRunner, NamesALogThatCannotBeWritten) {
  const TempDir dir;
  const FakeColmap fake("");
  const Listener silent = Silent();
  try {
    ColmapRunner(dir / "missing", silent, "sfm").Run("mapper", {}, "");
    ADD_FAILURE() << "no RunError was thrown";
  } catch (const RunError& error) {
    EXPECT_THAT(error.what(), StartsWith((dir / "missing").string() + "/colmap.log: cannot write"));
  }
  EXPECT_THROW(fake.Arguments(), InputError) << "the program has run";
}

TEST(ColmapRunner, StopsOnInterrupt) {
  const TempDir dir;
  const FakeColmap fake("echo 'Processed file [1/9]'; sleep 60");
  const Listener interrupt = [](const Event&) { RequestInterrupt(true); };
  EXPECT_THROW(ColmapRunner(dir.path(), interrupt, "sfm").Run("mapper", {}, ""), Interrupted);
  RequestInterrupt(false);
}

TEST(ColmapRunner, ExtractsFeaturesOnTheCpu) {
  const TempDir dir;
  WriteTwoImages(dir / "database.db");
  const std::string threads = std::to_string(NumThreads());
  for (const bool has_masks : {false, true}) {
    const FakeColmap fake("echo 'Processed file [2/2]'");
    const Steps steps;
    ColmapRunner(dir.path(), steps.listener, "sfm").ExtractFeatures("SIMPLE_RADIAL", has_masks);
    std::vector<std::string> want{"feature_extractor", "--database_path", (dir / "database.db").string(),
                                  "--ImageReader.camera_model", "SIMPLE_RADIAL"};
    if (has_masks) want.insert(want.end(), {"--ImageReader.mask_path", (dir / "masks").string()});
    want.insert(want.end(), {"--ImageReader.single_camera_per_folder", "1", "--SiftExtraction.max_image_size", "2000",
                             "--SiftExtraction.num_threads", threads, "--SiftExtraction.use_gpu", "0", "--image_path",
                             (dir / "images").string()});
    EXPECT_EQ(fake.Arguments(), want);
    EXPECT_THAT(steps.reported, ElementsAre("sfm 2/2 images, finding features"));
    const auto images = ReadDatabaseImages(dir / "database.db");
    EXPECT_EQ(images.at("a.png").image_id, 1u);
    EXPECT_EQ(images.at("b.png").image_id, 2u);
  }
}

TEST(ColmapRunner, RefusesSuccessWithoutADatabase) {
  const TempDir dir;
  const FakeColmap fake("");
  const Listener silent = Silent();
  try {
    ColmapRunner(dir.path(), silent, "sfm").ExtractFeatures("SIMPLE_RADIAL", false);
    ADD_FAILURE() << "no RunError was thrown";
  } catch (const RunError& error) {
    EXPECT_THAT(error.what(), StartsWith((dir / "database.db").string() + ": "));
  }
}

TEST(ColmapRunner, MatchesEveryPairOnTheCpu) {
  const TempDir dir;
  WriteTwoImages(dir / "database.db");
  const FakeColmap fake("echo 'Matching block [1/1, 1/1] in 0.1s'");
  const Steps steps;
  ColmapRunner(dir.path(), steps.listener, "sfm").MatchExhaustively();
  EXPECT_THAT(fake.Arguments(), ElementsAre("exhaustive_matcher", "--database_path", (dir / "database.db").string(),
                                            "--ExhaustiveMatching.block_size", "2", "--SiftMatching.num_threads",
                                            std::to_string(NumThreads()), "--SiftMatching.use_gpu", "0"));
  EXPECT_THAT(steps.reported, ElementsAre("sfm 0/1 pairs, matching", "sfm 1/1 pairs, matching"));
}

TEST(MatchingBlocks, CountEachPairOnce) {
  for (const int images : {2, 3, 12, 13, 60}) {
    for (const int threads : {1, 2, 16}) {
      const MatchingBlocks blocks = ChooseMatchingBlocks(images, threads);
      EXPECT_GE(blocks.size, 2) << "colmap asks for it";
      EXPECT_EQ(blocks.PairsUpTo(blocks.count(), blocks.count()), blocks.pairs()) << images;
      int64_t before = 0;
      for (int row = 1; row <= blocks.count(); ++row) {
        for (int column = 1; column <= blocks.count(); ++column) {
          EXPECT_GE(blocks.PairsUpTo(row, column), before);
          before = blocks.PairsUpTo(row, column);
        }
      }
    }
  }
  EXPECT_GE(ChooseMatchingBlocks(12, 2).count(), 3) << "12 photos are seen to advance";
  EXPECT_LE(ChooseMatchingBlocks(400, 1).count(), 10);
}

TEST(ColmapRunner, PassesAnotherDatabase) {
  const TempDir dir;
  WriteTwoImages(dir / "more.db");
  const std::string threads = std::to_string(NumThreads());
  const Listener silent = Silent();
  const ColmapRunner colmap(dir.path(), silent, "sfm", "more.db");
  {
    const FakeColmap fake("");
    colmap.ExtractFeatures("SIMPLE_RADIAL", false, {{"SiftExtraction.peak_threshold", "0.002"}});
    EXPECT_THAT(fake.Arguments(),
                testing::IsSupersetOf({(dir / "more.db").string(), std::string("--SiftExtraction.peak_threshold"),
                                       std::string("0.002")}));
  }
  {
    const FakeColmap fake("");
    colmap.MatchExhaustively({{"SiftMatching.max_ratio", "0.85"}});
    EXPECT_THAT(fake.Arguments(),
                ElementsAre("exhaustive_matcher", "--database_path", (dir / "more.db").string(),
                            "--ExhaustiveMatching.block_size", "2", "--SiftMatching.max_ratio", "0.85",
                            "--SiftMatching.num_threads", threads, "--SiftMatching.use_gpu", "0"));
  }
  const FakeColmap fake("");
  colmap.MatchPairs({{"camera0/a.png", "camera0/b.png"}, {"camera0/b.png", "camera1/c.png"}}, {}, "matching");
  EXPECT_EQ(ReadFile(dir / "pairs.txt"), "camera0/a.png camera0/b.png\ncamera0/b.png camera1/c.png\n");
  EXPECT_THAT(fake.Arguments(),
              ElementsAre("matches_importer", "--database_path", (dir / "more.db").string(),
                          "--SiftMatching.num_threads", threads, "--SiftMatching.use_gpu", "0", "--match_list_path",
                          (dir / "pairs.txt").string(), "--match_type", "pairs"));
}

TEST(ColmapRunner, AdjustsBundlesWithoutADatabase) {
  const TempDir dir;
  const FakeColmap fake("");
  const Listener silent = Silent();
  ColmapRunner(dir.path(), silent, "sfm").AdjustBundle(dir / "in", dir / "out");
  EXPECT_THAT(fake.Arguments(), ElementsAre("bundle_adjuster", "--input_path", (dir / "in").string(), "--output_path",
                                            (dir / "out").string()));
}

TEST(ColmapRunner, NamesTheLogOfAFailure) {
  const TempDir dir;
  Scene photos = WriteTexturedPlanes(dir / "scene", 2);
  photos.format = SceneFormat::kPhotos;
  for (SceneView& view : photos.views) {
    view.intrinsics = {};
    view.cam_from_world.reset();
  }
  const FakeColmap fake("echo 'ERROR: out of memory'; exit 1");
  try {
    RegisterViews(photos, dir / "sfm", Silent());
    ADD_FAILURE() << "no RunError was thrown";
  } catch (const RunError& error) {
    EXPECT_EQ(std::string(error.what()), "colmap feature_extractor ended with code 1: ERROR: out of memory; see " +
                                             (dir / "sfm" / "colmap.log").string());
  }
  EXPECT_EQ(ReadFile(dir / "sfm" / "colmap.log"), "ERROR: out of memory\n");
  EXPECT_FALSE(fs::exists(dir / "sfm" / "inputs.json")) << "a failed run must not look finished";
}

}  // namespace
}  // namespace oraclegs
