#include "oraclegs/run/reconstruct.h"

#include "oraclegs/datasets/read_scene.h"
#include "run/trained.h"
#include "support/errors.h"

namespace oraclegs {
namespace {

using testing::Contains;
using testing::HasSubstr;

using ReconstructTest = TrainedTest;

TEST_F(ReconstructTest, ScoresTheTestViewsAndKeepsThePictures) {
  EXPECT_GT(metrics->at("test").at("psnr"), 5);
  EXPECT_EQ(metrics->at("test").at("views").size(), 2u);
  EXPECT_GT(metrics->at("gaussians"), 0);
  EXPECT_EQ(metrics->at("train").at("iterations"), 30);
  int pictures = 0;
  for (const auto& entry : std::filesystem::directory_iterator(*temp / "out" / "renders" / "test")) {
    pictures += entry.path().extension() == ".png";
  }
  EXPECT_EQ(pictures, 4);
}

TEST_F(ReconstructTest, DoesNothingTwice) {
  const std::string before = ReadFile(*temp / "out" / "metrics.json");
  EXPECT_EQ(Reconstruct(*request, recorder.AsListener()), *metrics);
  EXPECT_TRUE(recorder.started.empty());
  EXPECT_EQ(ReadFile(*temp / "out" / "metrics.json"), before);
}

TEST_F(ReconstructTest, ADamagedTestPhotographIsFoundBeforeTraining) {
  const auto scene = MakeTinyScene(*temp / "damaged");
  RunRequest broken = TinyRequest(scene, *temp / "damaged_out");
  const Split split = ReadPosedScene(scene, broken.options, Silent()).split;
  const Scene read = ReadScene(scene, {}, Silent());
  const auto photo = read.views[static_cast<size_t>(split.test[0])].image_path;
  std::filesystem::resize_file(photo, std::filesystem::file_size(photo) / 2);
  EXPECT_THAT(MessageOf<InputError>([&] { Reconstruct(broken, recorder.AsListener()); }),
              HasSubstr(photo.filename().string()));
  EXPECT_TRUE(recorder.started.empty());
}

TEST_F(ReconstructTest, WithoutTestViewsThereAreNoScoresButAModel) {
  RunRequest all = TinyRequest(request->scene, *temp / "all");
  all.options.split.test_every = 0;
  const auto scored = Reconstruct(all, recorder.AsListener());
  EXPECT_TRUE(scored.at("test").at("psnr").is_null());
  EXPECT_THAT(recorder.notes, Contains(HasSubstr("all photos train")));
  EXPECT_EQ(scored.at("train_views").at("views").size(), scored.at("views").at("train"));
  EXPECT_FALSE(std::filesystem::is_empty(*temp / "all" / "renders" / "train"));
}

}  // namespace
}  // namespace oraclegs
