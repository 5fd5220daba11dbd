#include "oraclegs/train/checkpoint_folder.h"

#include <gmock/gmock.h>

#include <fstream>

#include "support/temp_dir.h"

namespace oraclegs {
namespace {

using testing::HasSubstr;

void Touch(const std::filesystem::path& path) { std::ofstream(path) << "any"; }

TEST(CheckpointFolder, NewestIsByNumberAndStrangersAreIgnored) {
  TempDir dir;
  EXPECT_FALSE(NewestCheckpoint(dir / "none").has_value());
  EXPECT_FALSE(NewestCheckpoint(dir.path()).has_value());
  for (const char* name :
       {"iteration_0000900.safetensors", "iteration_10000000.safetensors", "iteration_0009000.safetensors",
        "iteration_99999999.safetensors.tmp", "iteration_.safetensors", "iteration_9999999x.safetensors",
        "iteration_-1.safetensors", "zzz.safetensors"}) {
    Touch(dir / name);
  }
  EXPECT_EQ(NewestCheckpoint(dir.path()), dir / "iteration_10000000.safetensors");
}

TEST(CheckpointFolder, KeepsTheTwoNewestOfThisRun) {
  TempDir dir;
  for (const int64_t i : {100, 200, 300, 400, 9000}) Touch(CheckpointPath(dir.path(), i));
  Touch(dir / "notes.txt");
  RemoveOldCheckpoints(dir.path(), 400);
  std::vector<std::string> left;
  for (const auto& entry : std::filesystem::directory_iterator(dir.path())) left.push_back(entry.path().filename());
  EXPECT_THAT(left, testing::UnorderedElementsAre("iteration_0000300.safetensors", "iteration_0000400.safetensors",
                                                  "notes.txt"));
}

TEST(CheckpointFolder, RemovesWhatAKilledRunWasWriting) {
  TempDir dir;
  for (const char* name : {".oraclegs-999999999-3.tmp", ".oraclegs-999999998-0.tmp", "mine.tmp", ".oraclegs-notes"}) {
    Touch(dir / name);
  }
  Touch(CheckpointPath(dir.path(), 100));
  RemoveOldCheckpoints(dir.path(), 100);
  std::vector<std::string> left;
  for (const auto& entry : std::filesystem::directory_iterator(dir.path())) left.push_back(entry.path().filename());
  EXPECT_THAT(left, testing::UnorderedElementsAre("iteration_0000100.safetensors", "mine.tmp", ".oraclegs-notes"));
}

TEST(CheckpointFolder, SaysWhatIsLeftOfARun) {
  TempDir dir;
  EXPECT_EQ(WhereToContinue({}), "nothing was saved");
  EXPECT_THAT(WhereToContinue(dir.path()), HasSubstr("--checkpoint-every"));
  EXPECT_EQ(WhatIsSaved(dir.path()), "nothing had been saved");
  Touch(CheckpointPath(dir.path(), 100));
  EXPECT_THAT(WhereToContinue(dir.path()), HasSubstr("iteration_0000100.safetensors, is whole"));
  EXPECT_THAT(WhatIsSaved(dir.path()), HasSubstr("iteration_0000100.safetensors was saved"));
}

}  // namespace
}  // namespace oraclegs
