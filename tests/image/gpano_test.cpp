#include "oraclegs/image/gpano.h"

#include <gtest/gtest.h>

#include <string>

namespace oraclegs {
namespace {

std::string Attributes(const std::string& more = "") {
  return "\xff\xd8\xff\xe1..http://ns.adobe.com/xap/1.0/ <rdf:Description xmlns:GPano=\"http://ns.google.com/photos\" "
         "GPano:UsePanoramaViewer=\"True\" GPano:ProjectionType=\"equirectangular\" " +
         more + "/>";
}

std::string Area(int left, int top, int width, int height) {
  return "GPano:FullPanoWidthPixels=\"5760\" GPano:FullPanoHeightPixels=\"2880\" GPano:CroppedAreaLeftPixels=\"" +
         std::to_string(left) + "\" GPano:CroppedAreaTopPixels=\"" + std::to_string(top) +
         "\" GPano:CroppedAreaImageWidthPixels=\"" + std::to_string(width) +
         "\" GPano:CroppedAreaImageHeightPixels=\"" + std::to_string(height) + "\"";
}

TEST(ReadProjection, KnowsWholeSpheres) {
  EXPECT_EQ(ReadProjection(""), Projection::kPlain);
  EXPECT_EQ(ReadProjection("\xff\xd8\xff\xe0 a photo"), Projection::kPlain);
  EXPECT_EQ(ReadProjection(Attributes()), Projection::kSphere);
  EXPECT_EQ(ReadProjection(Attributes(Area(0, 0, 5760, 2880))), Projection::kSphere);
  EXPECT_EQ(ReadProjection("<GPano:ProjectionType>\n equirectangular </GPano:ProjectionType>"
                           "<GPano:FullPanoWidthPixels>100</GPano:FullPanoWidthPixels>"
                           "<GPano:CroppedAreaImageWidthPixels>100</GPano:CroppedAreaImageWidthPixels>"),
            Projection::kSphere);
  EXPECT_EQ(ReadProjection("GPano:ProjectionType = 'Equirectangular'"), Projection::kSphere);
}

TEST(ReadProjection, PartsOfSpheresAndOtherProjectionsArePanoramas) {
  EXPECT_EQ(ReadProjection(Attributes(Area(0, 400, 5760, 2080))), Projection::kPanorama);
  EXPECT_EQ(ReadProjection(Attributes(Area(10, 0, 5750, 2880))), Projection::kPanorama);
  EXPECT_EQ(ReadProjection(Attributes(Area(1, 0, 5760, 2880))), Projection::kPanorama);
  EXPECT_EQ(ReadProjection("GPano:ProjectionType=\"cylindrical\""), Projection::kPanorama);
  EXPECT_EQ(ReadProjection("GPano:ProjectionType=\"fisheye\""), Projection::kPanorama);
}

TEST(ReadProjection, DamageIsNoSphere) {
  const std::string whole = Attributes(Area(0, 0, 5760, 2880));
  for (size_t end = 0; end < whole.size(); ++end) {
    const Projection read = ReadProjection(whole.substr(0, end));
    const bool has_type = end >= whole.find("equirectangular") + 16;  // with its quote
    EXPECT_EQ(read == Projection::kPlain, end < whole.find(":ProjectionType") + 15) << end;
    EXPECT_TRUE(has_type || read != Projection::kSphere) << end;
  }
  for (const char* number : {"", "-5", "99999999999999999999", "5.5", "NaN", "0x10"}) {
    const std::string text = std::string("GPano:FullPanoWidthPixels=\"") + number + "\" " +
                             "GPano:CroppedAreaImageWidthPixels=\"" + number + "\"";
    EXPECT_EQ(ReadProjection(Attributes(text)), Projection::kPanorama) << number;
    EXPECT_EQ(ReadProjection(Attributes(std::string("GPano:CroppedAreaLeftPixels=\"") + number + "\"")),
              Projection::kPanorama)
        << number;
  }
  for (const std::string text : {"GPano:ProjectionType", "GPano:ProjectionType=", "GPano:ProjectionType=\"",
                                 "GPano:ProjectionType=equirectangular", "GPano:ProjectionType>equirectangular",
                                 "GPano:ProjectionTypes=\"equirectangular\""}) {
    EXPECT_EQ(ReadProjection(text), Projection::kPanorama) << text;
  }
  EXPECT_EQ(ReadProjection("GPano:ProjectionType=\"" + std::string(100000, 'e') + "\""), Projection::kPanorama);
}

}  // namespace
}  // namespace oraclegs
