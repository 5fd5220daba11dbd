#include "oraclegs/core/sha256.h"

#include <gtest/gtest.h>

namespace oraclegs {
namespace {

// The examples of FIPS 180-4 and of NIST's test suite.
TEST(Sha256, KnownDigests) {
  EXPECT_EQ(Sha256().Hex(), "e3b0c44298fc1c149afbf4c8996fb92427ae41e4649b934ca495991b7852b855");
  EXPECT_EQ(Sha256().Add("abc").Hex(), "ba7816bf8f01cfea414140de5dae2223b00361a396177a9cb410ff61f20015ad");
  EXPECT_EQ(Sha256().Add("abcdbcdecdefdefgefghfghighijhijkijkljklmklmnlmnomnopnopq").Hex(),
            "248d6a61d20638b8e5c026930c3e6039a33ce45964ff2167f6ecedd419db06c1");
  EXPECT_EQ(Sha256().Add(std::string(1'000'000, 'a')).Hex(),
            "cdc76e5c9914fb9281a1c7e284d73e67f1809a48a497200e046d39ccc7112cd0");
}

TEST(Sha256, PiecesMakeTheWholeForEveryCut) {
  std::string text;
  for (int i = 0; i < 200; ++i) text.push_back(static_cast<char>(i * 7));
  for (size_t size = 0; size <= text.size(); ++size) {
    const std::string whole = Sha256().Add(std::string_view(text).substr(0, size)).Hex();
    for (const size_t cut : {size / 3, size / 2, size}) {
      Sha256 pieces;
      pieces.Add(std::string_view(text).substr(0, cut));
      EXPECT_TRUE(IsSha256(pieces.Hex()));  // asking in between changes nothing
      pieces.Add(std::string_view(text).substr(cut, size - cut));
      EXPECT_EQ(pieces.Hex(), whole) << size << " " << cut;
    }
  }
}

TEST(Sha256, TellsDigestsFromOtherText) {
  EXPECT_TRUE(IsSha256(std::string(64, 'a')));
  EXPECT_FALSE(IsSha256(std::string(63, 'a')));
  EXPECT_FALSE(IsSha256(std::string(64, 'A')));
  EXPECT_FALSE(IsSha256(std::string(64, 'g')));
}

}  // namespace
}  // namespace oraclegs
