#include "oraclegs/weights/checkpoint/zip_directory.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "oraclegs/core/error.h"
#include "support/errors.h"
#include "torch_bytes.h"

namespace oraclegs {
namespace {

using testing::ElementsAre;
using testing::StartsWith;
using torch_bytes::Bytes;
using torch_bytes::Zip;

const torch_bytes::Parts kParts = {{"a/data.pkl", "first"}, {"a/data/0", "second part"}, {"a/none", ""}};

std::string ErrorOfZip(const std::string& file, const std::string& part = "a/data.pkl") {
  return MessageOf<InputError>([&] { (void)ZipDirectory(file, "f.pt").Content(part); });
}

TEST(ZipDirectory, FindsTheParts) {
  for (const bool wide : {false, true}) {
    const std::string file = Zip(kParts, wide);
    const ZipDirectory zip(file, "f.pt");
    EXPECT_THAT(zip.Names(), ElementsAre("a/data.pkl", "a/data/0", "a/none"));
    EXPECT_TRUE(zip.Has("a/none"));
    EXPECT_FALSE(zip.Has("none"));
    EXPECT_EQ(zip.Content("a/data/0"), "second part");
    EXPECT_EQ(zip.Content("a/none"), "");
  }
  EXPECT_EQ(ZipDirectory(Zip({}), "f.pt").Names().size(), 0u);
}

TEST(ZipDirectory, ReadsBehindAComment) {
  std::string file = Zip(kParts);
  file.replace(file.size() - 2, 2, Bytes(7, 2) + "comment");
  EXPECT_EQ(ZipDirectory(file, "f.pt").Content("a/data.pkl"), "first");
}

TEST(ZipDirectory, RefusesMissingParts) {
  EXPECT_EQ(ErrorOfZip(Zip(kParts), "a/\n"), "f.pt: lacks its part 'a/?'; the file is incomplete, get it again");
  EXPECT_EQ(ErrorOfZip(Zip({{"a", "1"}, {"a", "2"}})), "f.pt: is a zip with two parts 'a'; get the file again");
}

TEST(ZipDirectory, RefusesEveryTruncation) {
  for (const bool wide : {false, true}) {
    const std::string file = Zip(kParts, wide);
    for (size_t size = 0; size < file.size(); ++size) {
      EXPECT_THAT(ErrorOfZip(file.substr(0, size)), StartsWith("f.pt: is a ")) << size;
    }
  }
}

TEST(ZipDirectory, RefusesCompressedAndEncryptedParts) {
  const std::string file = Zip({{"a", "1234"}});
  const size_t entry = file.find("PK\1\2");
  for (const size_t at : {entry + 8, entry + 10}) {  // flags, method
    std::string changed = file;
    changed[at] = at == entry + 8 ? 1 : 8;
    EXPECT_EQ(ErrorOfZip(changed, "a"),
              "f.pt: its part 'a' is compressed or damaged; save the file with PyTorch again");
  }
}

TEST(ZipDirectory, ComparesNumbersWithTheFile) {
  const std::string file = Zip({{"a", "1234"}}, true);
  const size_t entry = file.find("PK\1\2"), extra = entry + 46 + 1 + 4, wide_end = file.find("PK\6\6");
  struct Change {
    size_t at, width;
  };
  // Size and stored size, place of a part; entries, bytes and place of the table; place of the wide end.
  for (const Change change : {Change{extra, 16},
                              {extra + 16, 8},
                              {wide_end + 32, 8},
                              {wide_end + 40, 8},
                              {wide_end + 48, 8},
                              {wide_end + 56 + 8, 8}}) {
    for (const uint64_t number : {~uint64_t{0}, uint64_t{1} << 40, static_cast<uint64_t>(file.size()) + 1}) {
      std::string changed = file;
      for (size_t i = 0; i < change.width; i += 8) changed.replace(change.at + i, 8, Bytes(number, 8));
      EXPECT_THAT(ErrorOfZip(changed, "a"), StartsWith("f.pt: ")) << change.at << " " << number;
    }
  }
}

TEST(ZipDirectory, RefusesDividedZips) {
  std::string file = Zip(kParts);
  file[file.size() - 22 + 4] = 1;
  EXPECT_EQ(ErrorOfZip(file), "f.pt: is one part of a divided zip; join the parts");
}

}  // namespace
}  // namespace oraclegs
