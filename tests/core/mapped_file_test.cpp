#include "oraclegs/core/mapped_file.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "oraclegs/core/error.h"
#include "oraclegs/core/files.h"
#include "support/errors.h"
#include "support/temp_dir.h"

namespace oraclegs {
namespace {

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

}  // namespace
}  // namespace oraclegs
