#include "oraclegs/core/atomic_file.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "oraclegs/core/error.h"
#include "oraclegs/core/files.h"
#include "support/errors.h"
#include "support/temp_dir.h"

namespace oraclegs {
namespace {

size_t FilesIn(const std::filesystem::path& folder) {
  return static_cast<size_t>(std::distance(std::filesystem::directory_iterator(folder), {}));
}

TEST(AtomicFile, AppearsWhenItIsFinished) {
  const TempDir dir;
  WriteFileAtomically(dir / "a", "old");
  {
    AtomicFile file(dir / "a");
    file.Append("new ");
    file.Append("content");
    EXPECT_EQ(ReadFile(dir / "a"), "old");
    file.Finish();
    EXPECT_EQ(ReadFile(dir / "a"), "new content");
  }
  EXPECT_EQ(FilesIn(dir.path()), 1u);
}

TEST(AtomicFile, LeavesNothingUnlessItIsFinished) {
  const TempDir dir;
  {
    AtomicFile file(dir / "a");
    file.Append("half");
    file.Flush();
    EXPECT_EQ(FilesIn(dir.path()), 1u);
  }
  EXPECT_EQ(FilesIn(dir.path()), 0u);
}

TEST(AtomicFile, NamesTheWantedFileInErrors) {
  const TempDir dir;
  EXPECT_EQ(MessageOf<RunError>([&] { AtomicFile file(dir / "none/a"); }),
            (dir / "none/a").string() + ": cannot write: No such file or directory");
  std::filesystem::create_directory(dir / "folder");
  AtomicFile file(dir / "folder");
  EXPECT_THAT(MessageOf<RunError>([&] { file.Finish(); }),
              testing::StartsWith((dir / "folder").string() + ": cannot write: "));
}

}  // namespace
}  // namespace oraclegs
