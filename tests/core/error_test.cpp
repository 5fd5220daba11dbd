#include "oraclegs/core/error.h"

#include <gtest/gtest.h>

#include <cerrno>

namespace oraclegs {
namespace {

TEST(Error, ExitCodeFollowsFromTheType) {
  EXPECT_EQ(UsageError("x").exit_code(), 2);
  EXPECT_EQ(InputError("x").exit_code(), 3);
  EXPECT_EQ(RunError("x").exit_code(), 4);
  EXPECT_EQ(Interrupted("x").exit_code(), 130);
}

TEST(Error, KeepsItsTypeThroughTheBase) {
  try {
    throw InputError("{}: has {} views", "scene", 1);
  } catch (const Error& error) {
    EXPECT_EQ(error.exit_code(), 3);
    EXPECT_STREQ(error.what(), "scene: has 1 views");
  }
}

TEST(Error, IsOneLineWhateverAFileSays) {
  EXPECT_STREQ(InputError("f: camera '{}' is unknown", "\x1b[2J\n.\x7f").what(), "f: camera '?[2J?.?' is unknown");
  EXPECT_STREQ(OutOfMemory("a\tb").what(), "a?b");
}

TEST(Error, WrongShapeIsABugAndNotTheUsers) {
  const ShapeError error("Render: means is {}", 4);
  EXPECT_STREQ(error.what(), "Render: means is 4");
  EXPECT_EQ(dynamic_cast<const Error*>(static_cast<const std::exception*>(&error)), nullptr);
}

TEST(SystemReason, SaysWhatToDoAboutAFullDisk) {
  EXPECT_EQ(SystemReason(ENOSPC), "No space left on device; make room there");
  EXPECT_EQ(SystemReason(EDQUOT), "Disk quota exceeded; make room there");
  EXPECT_EQ(SystemReason(std::error_code(ENOSPC, std::system_category())), "No space left on device; make room there");
}

TEST(SystemReason, IsWhatTheSystemSaysOtherwise) {
  EXPECT_EQ(SystemReason(EACCES), "Permission denied");
  EXPECT_EQ(SystemReason(std::make_error_code(std::errc::read_only_file_system)), "Read-only file system");
}

}  // namespace

}  // namespace oraclegs
