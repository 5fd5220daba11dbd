#include "oraclegs/formats/zip_archive.h"

#include "support/errors.h"

namespace oraclegs {
namespace {

using testing::HasSubstr;

std::string ZipError(const std::string& bytes, int64_t max_files = 9) {
  return MessageOf<InputError>([&] { ReadZip(bytes, max_files, "a.sog"); });
}

TEST(Zip, RoundTripsTheSameBytesEveryTime) {
  const std::string bytes = WriteZip({{"meta.json", "{}"}, {"a.webp", std::string(100000, 'x')}});
  EXPECT_EQ(bytes, WriteZip({{"meta.json", "{}"}, {"a.webp", std::string(100000, 'x')}}));
  EXPECT_GT(bytes.size(), 100000u);  // stored: images do not shrink
  const auto files = ReadZip(bytes, 9, "a.sog");
  EXPECT_EQ(files.size(), 2u);
  EXPECT_EQ(files.at("meta.json"), "{}");
  EXPECT_EQ(files.at("a.webp"), std::string(100000, 'x'));
}

TEST(Zip, RefusesDamagedArchives) {
  const std::string good = WriteZip({{"meta.json", "{}"}, {"a.webp", "xyz"}});
  EXPECT_THAT(ZipError(""), HasSubstr("a.sog: is empty"));
  EXPECT_THAT(ZipError("PK\3\4 and nothing"), HasSubstr("is not a zip archive"));
  EXPECT_THAT(ZipError(good.substr(0, good.size() - 30)), HasSubstr("is not a zip archive"));
  EXPECT_THAT(ZipError(good, 1), HasSubstr("has 2 files, expected at most 1"));
  std::string bad = good;
  bad[bad.find("xyz")] = 'q';  // the checksum does not fit any more
  EXPECT_THAT(ZipError(bad), HasSubstr("'a.webp' is damaged"));
}

TEST(Zip, BelievesNoSizeOfTheDirectory) {
  std::string bytes = WriteZip({{"a", std::string(100, 'x')}});
  const size_t directory = bytes.rfind("PK\1\2");
  bytes[directory + 20 + 3] = 0x7f;  // packed size
  bytes[directory + 24 + 3] = 0x7f;  // size
  EXPECT_NE(ZipError(bytes), "");
}

TEST(WriteZip, AlignsTheBytesOfFiles) {
  const std::vector<std::pair<std::string, std::string>> files = {
      {"a.txt", "w"}, {"longer name.png", std::string(100, 'y')}, {"b", std::string(61, 'z')}};
  const std::string archive = WriteZip(files, 64);
  for (const auto& [name, bytes] : files) EXPECT_EQ(archive.find(bytes) % 64, 0u) << name;
  EXPECT_EQ(ReadZip(archive, 3, "x"), (std::map<std::string, std::string>(files.begin(), files.end())));
}

}  // namespace
}  // namespace oraclegs
