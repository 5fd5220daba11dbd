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

TEST(RemoveDatabase, RemovesWhatLiesBesideIt) {
  const TempDir dir;
  for (const char* name : {"a.db", "a.db-wal", "b.db"}) WriteFileAtomically(dir / name, "x");
  RemoveDatabase(dir / "a.db");
  RemoveDatabase(dir / "a.db");  // is gone already
  EXPECT_FALSE(std::filesystem::exists(dir / "a.db"));
  EXPECT_FALSE(std::filesystem::exists(dir / "a.db-wal"));
  EXPECT_TRUE(std::filesystem::exists(dir / "b.db"));
}

TEST(CopyDatabase, ReplacesAndNamesBothFiles) {
  const TempDir dir;
  WriteFileAtomically(dir / "a.db", "new");
  WriteFileAtomically(dir / "b.db", "old");
  CopyDatabase(dir / "a.db", dir / "b.db");
  EXPECT_EQ(ReadFile(dir / "b.db"), "new");
  EXPECT_THAT(MessageOf<RunError>([&] { CopyDatabase(dir / "none.db", dir / "b.db"); }),
              testing::HasSubstr("none.db: cannot be copied to " + (dir / "b.db").string()));
}

TEST(PairId, HasNoOrder) { EXPECT_EQ(oraclegs::PairId(3, 5), oraclegs::PairId(5, 3)); }

}  // namespace
}  // namespace oraclegs
