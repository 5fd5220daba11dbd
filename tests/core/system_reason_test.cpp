#include "oraclegs/core/system_reason.h"

#include <gtest/gtest.h>

#include <cerrno>

namespace oraclegs {
namespace {

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
