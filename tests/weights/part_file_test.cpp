#include "oraclegs/weights/part_file.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <atomic>
#include <fstream>
#include <string>
#include <thread>

#include "oraclegs/core/error.h"
#include "oraclegs/core/files.h"
#include "support/temp_dir.h"

namespace oraclegs {
namespace {

using testing::EndsWith;
using testing::HasSubstr;
using testing::ThrowsMessage;

TEST(PartFile, FollowsNoLink) {
  const TempDir dir;
  WriteText(dir / "other", "keep");
  std::filesystem::create_symlink(dir / "other", dir / "f.part");
  EXPECT_THAT([&] { PartFile(dir / "f"); }, ThrowsMessage<RunError>(HasSubstr("f.part: cannot write")));
  EXPECT_EQ(ReadFile(dir / "other"), "keep");
}

TEST(PartFile, ContinuesWithTheSameChecksum) {
  const TempDir dir;
  {
    PartFile part(dir / "f");
    part.Append("ab");
  }
  EXPECT_EQ(ReadFile(dir / "f.part"), "ab");
  PartFile part(dir / "f");
  EXPECT_EQ(part.size(), 2u);
  part.Append("c");
  EXPECT_EQ(part.Sha256Hex(), Sha256().Add("abc").Hex());
  EXPECT_FALSE(std::filesystem::exists(dir / "f"));
  part.Finish();
  EXPECT_EQ(ReadFile(dir / "f"), "abc");
  EXPECT_FALSE(std::filesystem::exists(dir / "f.part"));
}

TEST(PartFile, RestartsAndDiscards) {
  const TempDir dir;
  PartFile part(dir / "f");
  part.Append("wrong");
  part.Restart();
  EXPECT_EQ(part.size(), 0u);
  part.Append("ok");
  EXPECT_EQ(part.Sha256Hex(), Sha256().Add("ok").Hex());
  EXPECT_EQ(ReadFile(dir / "f.part"), "ok");
  part.Discard();
  EXPECT_FALSE(std::filesystem::exists(dir / "f.part"));
}

TEST(PartFile, LocksOutOtherProcesses) {
  const TempDir dir;
  const PartFile part(dir / "f");
  EXPECT_THAT([&] { PartFile second(dir / "f"); },
              ThrowsMessage<RunError>(EndsWith("f.part: another process is downloading it; wait for that one")));
}

TEST(PartFile, LeavesAFileAloneThatAnotherProcessHasJustFinished) {
  const TempDir dir;
  std::atomic<int> finished = 0;
  const auto download = [&] {
    while (finished < 400) {
      try {
        PartFile part(dir / "f");
        part.Restart();
        part.Append("whole");
        part.Finish();
        ++finished;
      } catch (const RunError&) {  // the other one is at it
      }
    }
  };
  std::thread one(download), other(download);
  int cut = 0;
  while (finished < 400) {
    std::ifstream file(dir / "f");
    std::string text;
    if (file && (!(file >> text) || text != "whole")) ++cut;
  }
  one.join(), other.join();
  EXPECT_EQ(cut, 0) << "a reader has seen a finished file that was written to";
}

TEST(PartFile, NamesAFolderInTheWay) {
  const TempDir dir;
  PartFile part(dir / "f");
  std::filesystem::create_directories(dir / "f");
  EXPECT_THAT([&] { part.Finish(); }, ThrowsMessage<RunError>(HasSubstr("f.part: cannot rename: Is a directory")));
  EXPECT_THAT([&] { PartFile none(dir / "none/f"); },
              ThrowsMessage<RunError>(HasSubstr("f.part: cannot write: No such file")));
}

}  // namespace
}  // namespace oraclegs
