#include "oraclegs/core/file_facts.h"

#include <gtest/gtest.h>
#include <sys/stat.h>

#include <chrono>
#include <thread>

#include "oraclegs/core/error.h"
#include "oraclegs/core/sha256.h"
#include "support/temp_dir.h"

namespace oraclegs {
namespace {

namespace fs = std::filesystem;

/// Lets a file look as if nobody had changed its content for a while. The time of its status cannot be set.
void Age(const fs::path& file, int seconds) {
  fs::last_write_time(file, fs::file_time_type::clock::now() - std::chrono::seconds(seconds));
}

/// A file that changed longer ago than is unsure, which tests cannot make: one of the system's.
const fs::path kOldFile = "/etc/passwd";

TEST(StateOf, IsNothingForFilesThatMayStillChange) {
  const TempDir dir;
  WriteText(dir / "a", "text");
  EXPECT_FALSE(StateOf(dir / "a"));
  Age(dir / "a", 3600);
  EXPECT_FALSE(StateOf(dir / "a")) << "its status changed just now";
  EXPECT_FALSE(StateOf(dir / "none"));
  EXPECT_FALSE(StateOf(dir.path())) << "a folder";
  ASSERT_TRUE(StateOf(kOldFile));
  EXPECT_EQ(StateOf(kOldFile), StateOf(kOldFile));
  struct stat info = {};
  ASSERT_EQ(stat(kOldFile.c_str(), &info), 0);
  EXPECT_EQ((*StateOf(kOldFile))[2], info.st_size);
}

TEST(FileFacts, ReadsAFileOnceWhileItStays) {
  FileFacts<int> facts;
  int reads = 0;
  const auto read = [&] { return ++reads; };
  EXPECT_EQ(facts.Of(kOldFile, read), 1);
  EXPECT_EQ(facts.Of(kOldFile, read), 1);
  const TempDir dir;
  fs::create_symlink(kOldFile, dir / "link");
  EXPECT_EQ(facts.Of(dir / "link", read), 1) << "the same file";
  WriteText(dir / "new", "text");
  EXPECT_EQ(facts.Of(dir / "new", read), 2);
  EXPECT_EQ(facts.Of(dir / "new", read), 3) << "it may have changed meanwhile";
}

TEST(FileFacts, NoticesAChangeOfAKnownFile) {
  const TempDir dir;
  FileFacts<int> facts;
  int reads = 0;
  const auto read = [&] { return ++reads; };
  WriteText(dir / "a", "text");
  while (!StateOf(dir / "a")) std::this_thread::sleep_for(std::chrono::milliseconds(50));
  EXPECT_EQ(facts.Of(dir / "a", read), 1);
  EXPECT_EQ(facts.Of(dir / "a", read), 1);
  const auto time = fs::last_write_time(dir / "a");
  WriteText(dir / "a", "Text");
  fs::last_write_time(dir / "a", time);
  EXPECT_EQ(facts.Of(dir / "a", read), 2) << "of the same size and time of content";
}

TEST(FileFacts, KeepsNoErrors) {
  FileFacts<int> facts;
  const auto fails = []() -> int { throw InputError("damaged"); };
  EXPECT_THROW(facts.Of(kOldFile, fails), InputError);
  EXPECT_EQ(facts.Of(kOldFile, [] { return 7; }), 7);
}

TEST(DigestOf, HasTheChecksumsOfTheContent) {
  const TempDir dir;
  WriteText(dir / "a", "123456789");
  const FileDigest digest = DigestOf(dir / "a");
  EXPECT_EQ(digest.bytes, 9u);
  EXPECT_EQ(digest.crc32, 0xcbf43926u);
  EXPECT_EQ(digest.sha256, Sha256().Add(std::string_view("123456789\x09\0\0\0\0\0\0\0", 17)).Hex());
  WriteText(dir / "a", "123456780");
  EXPECT_NE(DigestOf(dir / "a").sha256, digest.sha256) << "changed in place";
  EXPECT_THROW(DigestOf(dir / "none"), InputError);
}

}  // namespace
}  // namespace oraclegs
