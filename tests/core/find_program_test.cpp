#include "oraclegs/core/find_program.h"

#include <gtest/gtest.h>

namespace oraclegs {
namespace {

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
