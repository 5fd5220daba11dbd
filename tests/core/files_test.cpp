#include "oraclegs/core/files.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/stat.h>

#include "oraclegs/core/error.h"
#include "support/errors.h"
#include "support/file_size_limit.h"
#include "support/temp_dir.h"

namespace oraclegs {
namespace fs = std::filesystem;
namespace {
using testing::AllOf;
using testing::HasSubstr;
using testing::Not;
using testing::ThrowsMessage;

size_t EntriesIn(const fs::path& dir) {
  return static_cast<size_t>(std::distance(fs::directory_iterator(dir), fs::directory_iterator()));
}

TEST(Files, WhatWasWrittenIsRead) {
  const TempDir dir;
  const std::string bytes("a\0b\r\n\xff", 6);
  WriteFileAtomically(dir / "file", bytes);
  EXPECT_EQ(ReadFile(dir / "file"), bytes);
  EXPECT_EQ(EntriesIn(dir.path()), 1u);
}

TEST(Files, AnEmptyFileIsAFile) {
  const TempDir dir;
  WriteFileAtomically(dir / "file", "");
  EXPECT_EQ(ReadFile(dir / "file"), "");
}

TEST(Files, WritingReplacesAndMakesFolders) {
  const TempDir dir;
  const fs::path path = dir.path() / "a" / "b" / "file";
  WriteFileAtomically(path, "a long first text");
  WriteFileAtomically(path, "second");
  EXPECT_EQ(ReadFile(path), "second");
  EXPECT_EQ(EntriesIn(path.parent_path()), 1u);
}

TEST(Files, WritesUnderTheLongestName) {
  const TempDir dir;
  const fs::path path = dir / std::string(255, 'n');
  WriteFileAtomically(path, "text");
  EXPECT_EQ(ReadFile(path), "text");
}

TEST(Files, AReaderHoldsOnToTheOldFile) {
  const TempDir dir;
  WriteFileAtomically(dir / "file", "old");
  fs::create_hard_link(dir / "file", dir / "link");  // what a program that has it open sees
  WriteFileAtomically(dir / "file", "new");
  EXPECT_EQ(ReadFile(dir / "link"), "old");
}

TEST(Files, ReadNamesTheFileAndTheReason) {
  const TempDir dir;
  EXPECT_THAT([&] { ReadFile(dir / "none"); },
              ThrowsMessage<InputError>(AllOf(HasSubstr("none"), HasSubstr("No such file"))));
  EXPECT_THAT([&] { ReadFile(dir.path()); },
              ThrowsMessage<InputError>(AllOf(HasSubstr(dir.path().string()), HasSubstr("is a folder"))));
  WriteFileAtomically(dir / "big", "12345");
  EXPECT_EQ(ReadFile(dir / "big", 5), "12345");
  EXPECT_THAT([&] { ReadFile(dir / "big", 4); },
              ThrowsMessage<InputError>(AllOf(HasSubstr("big"), HasSubstr("has 5 bytes, more than the 4"))));
}

TEST(Files, ReadDoesNotWaitForAPipe) {
  const TempDir dir;
  ASSERT_EQ(mkfifo((dir / "pipe").c_str(), 0600), 0);
  EXPECT_THAT([&] { ReadFile(dir / "pipe"); }, ThrowsMessage<InputError>(HasSubstr("is not a regular file")));
}

TEST(Files, FailedRenameLeavesNothing) {
  const TempDir dir;
  const fs::path too_long = dir / std::string(256, 'n');
  EXPECT_THAT([&] { WriteFileAtomically(too_long, "text"); },
              ThrowsMessage<RunError>(AllOf(HasSubstr(too_long.string()), HasSubstr("File name too long"))));
  EXPECT_EQ(EntriesIn(dir.path()), 0u);

  fs::create_directory(dir / "taken");
  EXPECT_THAT([&] { WriteFileAtomically(dir / "taken", "text"); },
              ThrowsMessage<RunError>(AllOf(HasSubstr("taken"), HasSubstr("Is a directory"))));
  EXPECT_EQ(EntriesIn(dir.path()), 1u);
}

TEST(Files, FailedWriteKeepsTheOldFileAndNothingElse) {
  const TempDir dir;
  WriteFileAtomically(dir / "file", "old");
  {
    const FileSizeLimit limit(1000);
    EXPECT_THAT([&] { WriteFileAtomically(dir / "file", std::string(5000, 'x')); },
                ThrowsMessage<RunError>(AllOf(HasSubstr("file: cannot write"), HasSubstr("File too large"))));
  }
  EXPECT_EQ(ReadFile(dir / "file"), "old");
  EXPECT_EQ(EntriesIn(dir.path()), 1u);
}

TEST(Files, ParentThatIsAFileIsNamed) {
  const TempDir dir;
  WriteFileAtomically(dir / "plain", "text");
  const auto message = AllOf(HasSubstr((dir / "plain").string()), Not(HasSubstr("\n")));
  EXPECT_THAT([&] { WriteFileAtomically(dir / "plain/file", "text"); }, ThrowsMessage<RunError>(message));
  EXPECT_THAT([&] { WriteFileAtomically(dir / "plain/a/b/file", "text"); }, ThrowsMessage<RunError>(message));
  EXPECT_THAT([&] { RequireWritableFolder(dir / "plain"); }, ThrowsMessage<RunError>(message));
  EXPECT_THAT([&] { RequireWritableFolder(dir / "plain/a"); }, ThrowsMessage<RunError>(message));
  EXPECT_EQ(ReadFile(dir / "plain"), "text");
}

TEST(Files, WritableFolderIsMadeAndLeftEmpty) {
  const TempDir dir;
  RequireWritableFolder(dir / "a/b");
  RequireWritableFolder(dir / "a/b");
  EXPECT_EQ(EntriesIn(dir / "a/b"), 0u);
}

TEST(Files, AFullDiskIsFoundBeforeTheRun) {
  const TempDir dir;
  const FileSizeLimit limit(0);
  EXPECT_THAT([&] { RequireWritableFolder(dir.path()); },
              ThrowsMessage<RunError>(AllOf(HasSubstr(dir.path().string()), HasSubstr("File too large"))));
  EXPECT_EQ(EntriesIn(dir.path()), 0u);
}

TEST(ReplaceFile, LeavesTheOldOrTheNew) {
  TempDir dir;
  ReplaceFile(dir / "a", "old");
  ReplaceFile(dir / "a", "new");
  EXPECT_EQ(ReadFile(dir / "a"), "new");
  EXPECT_EQ(EntriesIn(dir.path()), 1u) << "no temporary file is left";
  EXPECT_THROW(ReplaceFile(dir / "missing" / "a", "x"), RunError);
}

TEST(ReadHead, ReadsAtMostSoMuchOfAFile) {
  const TempDir dir;
  WriteFileAtomically(dir / "a", "abc");
  EXPECT_EQ(ReadHead(dir / "a", 2), "ab");
  EXPECT_EQ(ReadHead(dir / "a", 9), "abc");
  EXPECT_EQ(ReadHead(dir / "none", 9), "");
  EXPECT_EQ(ReadHead(dir.path(), 9), "");
}

TEST(IsFolder, KnowsFoldersAndLinksToThem) {
  const TempDir dir;
  WriteFileAtomically(dir / "a", "abc");
  std::filesystem::create_symlink(dir.path(), dir / "link");
  EXPECT_TRUE(IsFolder(dir.path()));
  EXPECT_TRUE(IsFolder(dir / "link"));
  EXPECT_FALSE(IsFolder(dir / "a"));
  EXPECT_FALSE(IsFolder(dir / "none"));
}

using testing::EndsWith;
using testing::StartsWith;

TEST(MapFile, KeepsTheBytesAsLongAsTheOwnerLives) {
  const TempDir dir;
  WriteFileAtomically(dir / "a", std::string("x\0y", 3));
  std::shared_ptr<const void> owner;
  std::string_view bytes;
  {
    const MappedFile file = MapFile(dir / "a");
    owner = file.owner;
    bytes = file.bytes;
  }
  std::filesystem::remove(dir / "a");
  EXPECT_EQ(bytes, std::string_view("x\0y", 3));
}

TEST(MapFile, OutlivesAFileThatIsCut) {
  const TempDir dir;
  const std::string content(100'000, 'x');
  WriteFileAtomically(dir / "a", content);
  const MappedFile file = MapFile(dir / "a");
  std::filesystem::resize_file(dir / "a", 10);
  EXPECT_EQ(file.bytes, content);
}

TEST(MapFile, RefusesWhatIsNoFile) {
  const TempDir dir;
  WriteFileAtomically(dir / "empty", "");
  EXPECT_THAT(MessageOf<InputError>([&] { MapFile(dir / "none"); }),
              EndsWith("none: cannot open: No such file or directory"));
  EXPECT_THAT(MessageOf<InputError>([&] { MapFile(dir / "empty"); }), EndsWith("empty: is empty; get the file again"));
  EXPECT_THAT(MessageOf<InputError>([&] { MapFile(dir.path()); }), StartsWith(dir.path().string() + ": "));
}

TEST(FindProgram, LooksInPath) {
  EXPECT_TRUE(std::filesystem::exists(FindProgram("sh")));
  EXPECT_TRUE(FindProgram("sh").is_absolute());
  EXPECT_EQ(FindProgram("/bin/sh"), "/bin/sh");
  EXPECT_EQ(FindProgram("oraclegs-no-such-program"), "");
  EXPECT_EQ(FindProgram(""), "");
  EXPECT_EQ(FindProgram("/etc/passwd"), "") << "a file that is no program";
  EXPECT_EQ(FindProgram("/tmp"), "") << "a folder";
}

TEST(FindLibraryFile, FindsTheLibrariesOfTheProgram) {
  const auto core = FindLibraryFile("liboraclegs_core.so");
  ASSERT_TRUE(core);
  EXPECT_TRUE(std::filesystem::is_regular_file(*core));
  EXPECT_FALSE(FindLibraryFile("liboraclegs_none.so"));
}

}  // namespace

}  // namespace oraclegs
