#include "oraclegs/output/live/curves.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "oraclegs/core/error.h"
#include "oraclegs/core/files.h"
#include "support/temp_dir.h"

namespace oraclegs {
namespace {

std::vector<int64_t> RowsOf(int64_t total) {
  std::vector<int64_t> rows;
  for (int64_t i = 0; i <= total; ++i) {
    if (HasCurveRow(i, total)) rows.push_back(i);
  }
  return rows;
}

TEST(Curves, HaveAtMost500RowsAndTheLast) {
  EXPECT_THAT(RowsOf(3), testing::ElementsAre(1, 2, 3));
  for (const int64_t total : {1, 499, 500, 501, 999, 1000, 1001, 7000, 7001, 30000}) {
    const auto rows = RowsOf(total);
    EXPECT_LE(rows.size(), 500u) << total;
    EXPECT_EQ(rows.back(), total);
  }
  EXPECT_EQ(RowsOf(7000).front(), 14);
  EXPECT_EQ(RowsOf(7000).size(), 500u);
}

TEST(Curves, AreReadBack) {
  TempDir dir;
  CurveRow full{3, 0.75, 0.0625, 120, 4.5};
  full.SetTerms({2, 4, 0.5, 0.25, 0.125, 0, 3, 0.75});
  full.psnr = 21.5;
  ReplaceFile(dir / "train.csv", CurvesToCsv({{1, 0.25, 0.5, 100}, full}));
  EXPECT_EQ(ReadFile(dir / "train.csv"),
            "iteration,seconds,ms_per_iteration,loss,l1,ssim,depth,alpha,proposal,regularization,gaussians,psnr\n"
            "1,0.250,,0.5,,,,,,,100,\n3,0.750,4.5,0.0625,0.25,0.875,0.0625,0,0.75,0.125,120,21.5\n");
  const auto rows = ReadCurves(dir / "train.csv");
  ASSERT_EQ(rows.size(), 2u);
  EXPECT_EQ(rows[1].iteration, 3);
  EXPECT_EQ(rows[1].seconds, 0.75);
  EXPECT_EQ(rows[1].loss, 0.0625);
  EXPECT_EQ(rows[1].gaussians, 120);
  EXPECT_EQ(rows[1].proposal, 0.75);
  EXPECT_EQ(rows[1].psnr, 21.5);
  EXPECT_TRUE(std::isnan(rows[0].psnr));
}

TEST(CurvesFile, GrowsByRows) {
  TempDir dir;
  std::vector<CurveRow> rows = {{1, 1, 0.5, 10}};
  CurvesFile file(dir / "c");
  file.Write(rows);
  for (int i = 2; i < 5; ++i) {
    rows.push_back({i, 1. * i, 0.5, 10});
    file.Append(rows);
    EXPECT_EQ(ReadFile(dir / "c"), CurvesToCsv(rows));
  }
  rows.resize(2);
  file.Write(rows);
  EXPECT_EQ(ReadFile(dir / "c"), CurvesToCsv(rows));
}

TEST(CurvesFile, IsWholeAgainAfterAFailure) {
  TempDir dir;
  std::filesystem::create_directories(dir / "c" / "in_the_way");
  std::vector<CurveRow> rows = {{1, 1, 0.5, 10}};
  CurvesFile file(dir / "c");
  EXPECT_THROW(file.Write(rows), RunError);
  rows.push_back({2, 2, 0.5, 10});
  EXPECT_THROW(file.Append(rows), RunError);
  std::filesystem::remove_all(dir / "c");
  rows.push_back({3, 3, 0.5, 10});
  file.Append(rows);
  EXPECT_EQ(ReadFile(dir / "c"), CurvesToCsv(rows));
}

TEST(Curves, DamagedRowsAreLeftOut) {
  TempDir dir;
  EXPECT_TRUE(ReadCurves(dir / "missing").empty());
  EXPECT_TRUE(ReadCurves(dir.path()).empty());
  WriteText(dir / "c",
            "nonsense\n1,1,,0.5,,,,,,,10,\n1,1,,0.5,,,,,,,10,\n2,nan,,0.5,,,,,,,10,\n3,1,,inf,,,,,,,10,\n"
            "4,1,,0.5,,,,,,,10,,7\n4,1,,0.5,,,x,,,,10,\n4,1,,0.5,,,,,,,,\n5,2,3,0.4,,,,,,,20,19\n6,2");
  const auto rows = ReadCurves(dir / "c");
  ASSERT_EQ(rows.size(), 2u);
  EXPECT_EQ(rows[0].iteration, 1);
  EXPECT_EQ(rows[1].iteration, 5);
}

TEST(Curves, AreJsonOfAtMost500Points) {
  std::vector<CurveRow> rows;
  for (int i = 1; i <= 1200; ++i) rows.push_back({i, 0.1 * i, 1. / i, 10 * i});
  const nlohmann::json curves = CurvesToJson(rows);
  ASSERT_EQ(curves.size(), 2u);
  for (const auto& curve : curves) {
    EXPECT_EQ(curve.at("x_name"), "iteration");
    EXPECT_LE(curve.at("x").size(), 500u);
    EXPECT_EQ(curve.at("x").size(), curve.at("y").size());
    EXPECT_EQ(curve.at("x").back(), 1200);
  }
  EXPECT_EQ(curves[0].at("name"), "loss");
  EXPECT_EQ(curves[1].at("y").back(), 12000);
  rows[599].psnr = 20;
  const nlohmann::json scored = CurvesToJson(rows);
  ASSERT_EQ(scored.size(), 3u);
  EXPECT_EQ(scored[2].at("x"), nlohmann::json({600}));
  EXPECT_EQ(scored[2].at("unit"), "dB");
}

}  // namespace
}  // namespace oraclegs
