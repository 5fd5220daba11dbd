#include "oraclegs/output/report/run_document.h"

#include <gmock/gmock.h>

#include <nlohmann/json.hpp>

#include "oraclegs/core/files.h"
#include "oraclegs/formats/codecs.h"
#include "oraclegs/stages/run_observer.h"
#include "run/trained.h"

namespace oraclegs {
namespace {

namespace fs = std::filesystem;
using nlohmann::json;
using RunDocumentTest = TrainedTest;

/// Every {"url": ...} of the document.
void CollectUrls(const json& part, std::vector<std::string>* urls) {
  if (part.is_object() && part.contains("url")) urls->push_back(part["url"].get<std::string>());
  if (!part.is_structured()) return;
  for (const json& inner : part) CollectUrls(inner, urls);
}

TEST_F(RunDocumentTest, NamesFilesThatAreThere) {
  const json document = json::parse(ReadFile(*temp / "out/report/run.json"));
  EXPECT_TRUE(document.at("finished").get<bool>());
  std::vector<std::string> urls;
  CollectUrls(document, &urls);
  EXPECT_GT(urls.size(), 10u);
  for (const std::string& url : urls) {
    EXPECT_TRUE(url.starts_with("report/") || url == "renders/orbit/video.mp4") << url;
    EXPECT_TRUE(std::filesystem::is_regular_file(*temp / "out" / url)) << url;
  }
}

TEST_F(RunDocumentTest, ShowsWhatWasTrainedAndScored) {
  const json document = json::parse(ReadFile(*temp / "out/report/run.json"));
  int train = 0, test = 0;
  for (const json& view : document.at("views")) {
    train += view["role"] == "train" ? 1 : 0;
    if (view["role"] != "test") continue;
    ++test;
    for (const char* part : {"image", "render", "error", "support", "psnr", "ssim"})
      EXPECT_TRUE(view.contains(part)) << part;
    EXPECT_EQ(view["camera"]["world_to_camera"].size(), 16u);
    EXPECT_EQ(view["camera"]["world_to_camera"][15], 1);
  }
  EXPECT_EQ(train, 4);
  EXPECT_EQ(test, 2);
  EXPECT_EQ(document["scores"]["psnr"], metrics->at("test").at("psnr"));
  const json& splat = document.at("splat");
  const GaussianPly shown = DecodeSpz(ReadFile(*temp / "out" / splat["url"].get<std::string>()), "splat.spz");
  EXPECT_EQ(shown.gaussians.size(), splat["gaussians"].get<int64_t>());
  EXPECT_EQ(std::filesystem::file_size(*temp / "out/report/support.bin"), splat["gaussians"].get<uint64_t>());
  EXPECT_EQ(std::filesystem::file_size(*temp / "out/report/points.bin"),
            15 * document["points"]["count"].get<uint64_t>());
  double shares = 0;
  for (const json& row : document["support"]["classes"]) shares += row["gaussians"].get<double>();
  EXPECT_NEAR(shares, 1, 1e-6);
}

TEST_F(RunDocumentTest, BeginsBeforeThereIsASplat) {
  RunRequest other = *request;
  other.out = *temp / "begun";
  oraclegs::Run run = StartRun(other, Silent());
  Bring(&run, "validate");
  ShowDocument(&run, "train");
  const json document = json::parse(ReadFile(other.out / "report/run.json"));
  EXPECT_FALSE(document.at("finished").get<bool>());
  EXPECT_TRUE(document.at("splat").is_null());
  EXPECT_EQ(document.at("views").size(), 4u) << "the training views alone: test images are not looked at";
  EXPECT_GT(document.at("place").at("radius"), 0);
}

TEST_F(RunDocumentTest, ShowsPhotosBeforeTheirCamerasAreKnown) {
  RunRequest other = *request;
  other.out = *temp / "photos";
  oraclegs::Run run = StartRun(other, Silent());
  fs::remove_all(other.out / "report");
  ShowDocument(&run, kPhotosRead);
  const fs::path file = other.out / "report/run.json";
  const json document = json::parse(ReadFile(file));
  EXPECT_EQ(document.at("title"), "photos") << "the workspace's name";
  EXPECT_EQ(document.at("views").size(), run.scene.views.size());
  EXPECT_FALSE(document.at("views")[0].contains("camera"));
  EXPECT_TRUE(fs::exists(other.out / document.at("views")[0].at("thumbnail").at("url").get<std::string>()));

  ShowDocument(&run, "register");
  EXPECT_TRUE(json::parse(ReadFile(file)).at("views")[0].contains("camera"));
  WriteFileAtomically(file, R"({"finished": true})");
  ShowDocument(&run, kPhotosRead);
  ShowDocument(&run, "register");
  EXPECT_EQ(ReadFile(file), R"({"finished": true})") << "a finished run's stays until training begins";
  run.options.report.report = false;
  ShowDocument(&run, "train");
  EXPECT_EQ(ReadFile(file), R"({"finished": true})");
}

TEST_F(RunDocumentTest, GivesTheCommandThatMakesTheRunAgain) {
  RunRequest odd = *request;
  odd.out = *temp / "my scene's run";
  const oraclegs::Run run = StartRun(odd, Silent());
  const std::string command = CommandOf(run);
  EXPECT_THAT(command, testing::StartsWith("oraclegs reconstruct " + request->scene.string() + " -o "));
  EXPECT_THAT(command, testing::HasSubstr("my scene'\\''s run'"));
  EXPECT_THAT(command, testing::HasSubstr(" --iterations 30"));
  EXPECT_THAT(command, testing::HasSubstr(" --proposers none"));
  EXPECT_THAT(command, testing::Not(testing::HasSubstr("--views")));
}

}  // namespace
}  // namespace oraclegs
