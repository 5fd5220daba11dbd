#include "oraclegs/sfm/database_file.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "oraclegs/core/error.h"
#include "oraclegs/core/files.h"
#include "support/errors.h"
#include "support/temp_dir.h"

namespace oraclegs {
namespace {

TEST(DatabaseFile, NamesTheFileThatIsNone) {
  const TempDir dir;
  const std::string path = (dir / "database.db").string();
  EXPECT_THAT(MessageOf<RunError>([&] { DatabaseFile open(path); }), testing::StartsWith(path + ": was not written"));
  WriteFileAtomically(path, "no database at all, but long enough to be one");
  EXPECT_THAT(MessageOf<RunError>([&] { DatabaseFile(path).Execute("CREATE TABLE a (b INTEGER)"); }),
              testing::HasSubstr("run the same command again"));
}

TEST(PairId, HasNoOrder) { EXPECT_EQ(oraclegs::PairId(3, 5), oraclegs::PairId(5, 3)); }

}  // namespace
}  // namespace oraclegs
