#include "oraclegs/core/library_file.h"

#include <gtest/gtest.h>

namespace oraclegs {
namespace {

TEST(FindLibraryFile, FindsTheLibrariesOfTheProgram) {
  const auto core = FindLibraryFile("liboraclegs_core.so");
  ASSERT_TRUE(core);
  EXPECT_TRUE(std::filesystem::is_regular_file(*core));
  EXPECT_FALSE(FindLibraryFile("liboraclegs_none.so"));
}

}  // namespace
}  // namespace oraclegs
