#include "oraclegs/output/report/report_files.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "oraclegs/core/error.h"
#include "oraclegs/core/files.h"
#include "oraclegs/image/codecs.h"
#include "support/temp_dir.h"

namespace oraclegs {
namespace {

TEST(ReportFiles, ReducesLargeImages) {
  const TempDir out;
  const ReportFiles files(out.path());
  const Image8 wide{1920, 480, 3, std::vector<uint8_t>(1920 * 480 * 3, 90)};
  const nlohmann::json image = files.Image("wide", wide), small = files.Thumbnail("wide_small", wide);
  EXPECT_EQ(image["url"], "report/images/wide.jpg");
  int width = 0, height = 0;
  ReadJpegSize(ReadFile(out / "report/images/wide.jpg"), "wide", Orientation::kUpright, &width, &height);
  EXPECT_EQ(width, 960);
  EXPECT_EQ(height, 240);
  ReadJpegSize(ReadFile(out / small["url"].get<std::string>()), "small", Orientation::kUpright, &width, &height);
  EXPECT_EQ(width, 200);
}

TEST(WithFilesInside, ReplacesEveryPathByItsContent) {
  const TempDir out;
  const ReportFiles files(out.path());
  nlohmann::json document = {{"title", "report/x.bin"}, {"list", {{{"image", files.Bytes("x.bin", "Ma")}}}}};
  document["page"] = files.Bytes("y.jpg", "Man!");
  const nlohmann::json inside = WithFilesInside(document, out.path());
  EXPECT_EQ(inside["list"][0]["image"]["url"], "data:application/octet-stream;base64,TWE=");
  EXPECT_EQ(inside["page"]["url"], "data:image/jpeg;base64,TWFuIQ==");
  EXPECT_EQ(inside["title"], "report/x.bin");
  std::filesystem::remove(out / "report/x.bin");
  EXPECT_THROW(WithFilesInside(document, out.path()), InputError);
}

}  // namespace
}  // namespace oraclegs
