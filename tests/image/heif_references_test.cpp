#include "oraclegs/image/heif_references.h"

#include "image/heif_boxes.h"
#include "image/jpeg_files.h"
#include "oraclegs/image/heif.h"
#include "support/errors.h"

namespace oraclegs {
namespace {

using ::testing::HasSubstr;

bool IsFinite(const std::string& references) { return HasFinitePieces(GridFile(16, 8, references)); }

TEST(HasFinitePieces, AcceptsPhotos) {
  EXPECT_TRUE(HasFinitePieces(EncodeHeif(SmoothImage(16, 8, 4), PhoneExif())));
  EXPECT_TRUE(IsFinite(""));
  EXPECT_TRUE(IsFinite(HeifReference("dimg", 2, {1, 1, 1}) + HeifReference("auxl", 3, {2})));
  EXPECT_TRUE(IsFinite(HeifReference("cdsc", 2, {2}))) << "what describes is not decoded";
  EXPECT_TRUE(HasFinitePieces(""));
}

TEST(HasFinitePieces, RefusesCircles) {
  EXPECT_FALSE(IsFinite(HeifReference("dimg", 2, {2})));
  EXPECT_FALSE(IsFinite(HeifReference("dimg", 2, {1}) + HeifReference("dimg", 1, {2})));
  EXPECT_FALSE(IsFinite(HeifReference("auxl", 2, {2})));
  EXPECT_FALSE(IsFinite(HeifReference("dimg", 2, {1}) + HeifReference("auxl", 2, {1})));
  EXPECT_THAT(MessageOf<InputError>([] { DecodeHeif(GridFile(16, 8, HeifReference("dimg", 2, {2})), "a.heic"); }),
              HasSubstr("a.heic: is a damaged HEIF image (made of itself"));
}

TEST(HasFinitePieces, RefusesManifoldsOfManifolds) {
  std::string references;
  for (uint64_t id = 2; id < 8; ++id) references += HeifReference("dimg", id, std::vector<uint64_t>(10, id + 1));
  EXPECT_FALSE(IsFinite(references)) << "a million";
  EXPECT_TRUE(IsFinite(HeifReference("dimg", 2, std::vector<uint64_t>(2000, 1))));
}

}  // namespace
}  // namespace oraclegs
