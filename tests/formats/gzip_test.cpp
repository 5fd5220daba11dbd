#include "oraclegs/formats/gzip.h"

#include "support/errors.h"

namespace oraclegs {
namespace {

TEST(Gzip, RoundTripsInPieces) {
  std::string bytes;
  for (uint32_t i = 0; i < 3000000; ++i) bytes += static_cast<char>(i * i >> 7);
  const std::string packed = Gzip(bytes);
  EXPECT_LT(packed.size(), bytes.size());
  Gunzip unpacked(packed, "a.gz");
  EXPECT_EQ(unpacked.Next(5), bytes.substr(0, 5));
  EXPECT_EQ(unpacked.Next(1 << 30), bytes.substr(5));
  EXPECT_EQ(unpacked.Next(10), "");
}

TEST(Gunzip, UnpacksNoMoreThanAskedOfABomb) {
  const std::string packed = Gzip(std::string(100 << 20, '\0'));  // which the reader does not own
  Gunzip bomb(packed, "a.gz");
  EXPECT_EQ(bomb.Next(100).size(), 100u);
}

TEST(Gunzip, RefusesWhatIsDamaged) {
  const std::string packed = Gzip("some text that is long enough to be cut in two pieces");
  EXPECT_THAT(MessageOf<InputError>([] { Gunzip("PK", "a.gz"); }), testing::HasSubstr("a.gz: is not compressed"));
  EXPECT_THAT(MessageOf<InputError>([] { Gunzip("", "a.gz"); }), testing::HasSubstr("a.gz: is not compressed"));
  for (const size_t size : {size_t{2}, size_t{11}, packed.size() - 1}) {
    EXPECT_THAT(MessageOf<InputError>([&] { Gunzip(packed.substr(0, size), "a.gz").Next(1000); }),
                testing::HasSubstr("damaged or cut short"));
  }
  std::string flipped = packed;
  flipped[packed.size() - 5] ^= 1;  // the checksum
  EXPECT_THAT(MessageOf<InputError>([&] { Gunzip(flipped, "a.gz").Next(1000); }), testing::HasSubstr("damaged"));
}

}  // namespace
}  // namespace oraclegs
