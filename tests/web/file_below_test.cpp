#include "oraclegs/web/file_below.h"

#include <fcntl.h>
#include <gtest/gtest.h>
#include <sys/stat.h>

#include <set>
#include <string>

#include "support/temp_dir.h"

namespace oraclegs {
namespace {

namespace fs = std::filesystem;

TEST(IsPlainPath, RefusesWhatLeadsElsewhere) {
  for (const char* good : {"a", "a/b.png", "live/splat.splat", ".hidden", "a..b/c", "\xc3\xa4/x", "a b/c"}) {
    EXPECT_TRUE(IsPlainPath(good)) << good;
  }
  for (const char* bad : {"", "/", "/a", "a/", "a//b", "..", "../a", "a/..", "a/../b", ".", "./a", "a/./b", "a\\b",
                          "..\\a", "a\nb", "\x7f", "\xff\xfe"}) {
    EXPECT_FALSE(IsPlainPath(bad)) << bad;
  }
  EXPECT_FALSE(IsPlainPath(std::string_view("a\0b", 3)));
  EXPECT_FALSE(IsPlainPath(std::string(256, 'a')));
  std::string deep = "a";
  while (deep.size() <= 1024) deep += "/a";
  EXPECT_FALSE(IsPlainPath(deep));
}

TEST(FileBelow, ReadsRegularFiles) {
  TempDir dir;
  WriteText(dir / "a" / "b", "content");
  const auto file = FileBelow::Open(dir.path(), "a/b");
  ASSERT_TRUE(file);
  EXPECT_EQ(file->size(), 7u);
  EXPECT_EQ(file->ReadAll(7), "content");
  EXPECT_FALSE(file->ReadAll(6));
  char part[4];
  EXPECT_EQ(file->ReadAt(5, part, 4), 2u);
  WriteText(dir / "a" / "b", "longer content");
  EXPECT_NE(FileBelow::Open(dir.path(), "a/b")->tag(), file->tag());
}

TEST(FileBelow, TagsTimesThatNoClockHasYet) {
  TempDir dir;
  WriteText(dir / "a", "content");
  std::set<std::string> tags;
  for (const time_t seconds : {time_t{1} << 34, -(time_t{1} << 31), time_t{9'300'000'000}}) {
    const timespec times[] = {{seconds, 7}, {seconds, 7}};
    ASSERT_EQ(utimensat(AT_FDCWD, (dir / "a").c_str(), times, 0), 0);
    const auto file = FileBelow::Open(dir.path(), "a");
    ASSERT_TRUE(file);
    tags.insert(file->tag());
  }
  EXPECT_GE(tags.size(), 2u) << "file systems bend times that they cannot hold";
}

TEST(FileBelow, OpensNothingElse) {
  TempDir dir;
  WriteText(dir / "secret", "secret");
  fs::create_directories(dir / "root" / "folder");
  const fs::path root = dir / "root";
  fs::create_symlink(dir / "secret", root / "link");
  fs::create_symlink(dir.path(), root / "folder_link");
  ASSERT_EQ(mkfifo((root / "pipe").c_str(), 0600), 0);
  for (const char* path : {"link", "folder_link/secret", "folder", "pipe", "missing", "folder/missing", "../secret"}) {
    EXPECT_FALSE(FileBelow::Open(root, path)) << path;
  }
  EXPECT_FALSE(FileBelow::Open(dir / "missing", "a"));
  WriteText(root / "a", "a");
  fs::create_symlink(root, dir / "root_link");
  EXPECT_TRUE(FileBelow::Open(dir / "root_link", "a")) << "the user names the root";
}

}  // namespace
}  // namespace oraclegs
