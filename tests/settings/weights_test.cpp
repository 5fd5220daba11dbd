#include "oraclegs/settings/weights.h"

#include <cstdlib>

#include "run/fixtures.h"
#include "support/errors.h"
#include "support/network_files.h"
#include "support/temp_dir.h"

namespace oraclegs {
namespace {

namespace fs = std::filesystem;
using testing::AllOf;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;

/// Sets $ORACLEGS_MODELS and $HOME for the length of a test.
class WeightsTest : public testing::Test {
 protected:
  ~WeightsTest() override {
    setenv("ORACLEGS_MODELS", "/nonexistent", 1);  // as fixtures.h has it
    setenv("HOME", home_.c_str(), 1);
  }
  void SetUp() override { setenv("ORACLEGS_MODELS", temp.path().c_str(), 1); }

  fs::path Put(const std::string& file) const {
    fs::create_directories((temp / file).parent_path());
    WriteText(temp / file, file);
    return temp / file;
  }
  static DepthSource Choose(Auto<DepthPrior> prior, const fs::path& weights = {}) {
    RunOptions options;
    options.depth.depth_prior = prior, options.weights.depth_weights = weights;
    return ChooseDepthSource(options);
  }

  TempDir temp;

 private:
  std::string home_ = std::getenv("HOME") != nullptr ? std::getenv("HOME") : "";
};

TEST_F(WeightsTest, ASensorIsTakenWhereMostPhotosHaveOne) {
  RunOptions options;
  EXPECT_EQ(ChooseDepthSource(options, SensorDepth::kMost).prior, DepthPrior::kSensor);
  EXPECT_EQ(ChooseDepthSource(options, SensorDepth::kSome).prior, DepthPrior::kStereo);
  options.method.method = "fsgs";
  EXPECT_EQ(ChooseDepthSource(options, SensorDepth::kMost).prior, DepthPrior::kStereo) << "other papers have none";
  options.depth.depth_prior = DepthPrior::kSensor;
  EXPECT_EQ(ChooseDepthSource(options, SensorDepth::kSome).prior, DepthPrior::kSensor);
  EXPECT_FALSE(ChooseDepthSource(options, SensorDepth::kSome).HasNetwork());
  EXPECT_THAT(MessageOf<InputError>([&] { ChooseDepthSource(options); }),
              HasSubstr("--depth-prior sensor: no photo of the scene has a depth of a sensor"));
  options.depth.depth_prior = DepthPrior::kStereo;
  EXPECT_EQ(ChooseDepthSource(options, SensorDepth::kMost).prior, DepthPrior::kStereo);
}

TEST_F(WeightsTest, AreFoundInTheModelsFolder) {
  EXPECT_THAT(FindWeights("lpips-vgg", {}), IsEmpty());
  const fs::path b = Put("lpips-vgg/b.safetensors"), a = Put("lpips-vgg/a.safetensors");
  Put("lpips-vgg/LICENSE");
  EXPECT_THAT(FindWeights("lpips-vgg", {}), ElementsAre(a, b));
  EXPECT_THAT(FindWeights("lpips-alex", {}), IsEmpty());
  const fs::path single = Put("lpips-vgg.safetensors");
  EXPECT_THAT(FindWeights("lpips-vgg", {}), ElementsAre(single));
  unsetenv("ORACLEGS_MODELS");
  setenv("HOME", temp.path().c_str(), 1);
  EXPECT_THAT(FindWeights("lpips-vgg", {}), IsEmpty());
  const fs::path cached = Put(".cache/oraclegs/lpips-vgg/model.safetensors");
  EXPECT_THAT(FindWeights("lpips-vgg", {}), ElementsAre(cached));
  unsetenv("HOME");
  EXPECT_THAT(FindWeights("lpips-vgg", {}), IsEmpty());
}

TEST_F(WeightsTest, AreThoseThatAreNamed) {
  Put("lpips-vgg/a.safetensors");
  const fs::path own = Put("own/mine.safetensors");
  EXPECT_THAT(FindWeights("lpips-vgg", own), ElementsAre(own));
  EXPECT_THAT(FindWeights("lpips-vgg", temp / "own"), ElementsAre(own));
  EXPECT_THAT(MessageOf<InputError>([&] { FindWeights("lpips-vgg", temp / "none"); }),
              AllOf(HasSubstr((temp / "none").string()), HasSubstr("does not exist"), HasSubstr("lpips-vgg")));
  fs::create_directories(temp / "empty");
  EXPECT_THAT(MessageOf<InputError>([&] { FindWeights("lpips-vgg", temp / "empty"); }),
              HasSubstr("has no .safetensors file in it"));
}

TEST_F(WeightsTest, KeypointsNeedAFileAndALibrary) {
  EXPECT_EQ(FindKeypointWeights(), "");
  const fs::path file = Put("aliked-n16/model.safetensors");
  EXPECT_EQ(FindKeypointWeights(), HasNetworks() ? file : fs::path());
}

TEST_F(WeightsTest, AutoTakesTheNetworkWhereItIs) {
  EXPECT_EQ(Choose({}).prior, DepthPrior::kStereo);
  EXPECT_FALSE(Choose({}).HasNetwork());
  SKIP_WITHOUT_NETWORKS();
  const fs::path file = Put("depth-anything-v2-small/model.safetensors");
  const DepthSource source = Choose({});
  EXPECT_EQ(source.prior, DepthPrior::kFused);
  EXPECT_EQ(source.weights, file);
  EXPECT_EQ(Choose(DepthPrior::kMonocular).prior, DepthPrior::kMonocular);
  EXPECT_EQ(Choose(DepthPrior::kStereo).weights, "");
  EXPECT_EQ(Choose(DepthPrior::kNone).prior, DepthPrior::kNone);
  EXPECT_EQ(Choose(DepthPrior::kFused, Put("mine.safetensors")).weights, temp / "mine.safetensors");
}

TEST_F(WeightsTest, ANetworkThatIsAskedForMustBeThere) {
  for (const DepthPrior prior : {DepthPrior::kFused, DepthPrior::kMonocular}) {
    EXPECT_THAT(MessageOf<InputError>([&] { Choose(prior); }),
                AllOf(HasSubstr("--depth-prior " + Word(prior)),
                      HasSubstr("`oraclegs models fetch depth-anything-v2-small`"), HasSubstr("--depth-weights")));
  }
  EXPECT_THAT(MessageOf<InputError>([&] { Choose({}, temp / "none.safetensors"); }), HasSubstr("does not exist"));
  Put("depth-anything-v2-small/a.safetensors"), Put("depth-anything-v2-small/b.safetensors");
  EXPECT_THAT(MessageOf<InputError>([&] { Choose({}); }),
              AllOf(HasSubstr("holds 2 files"), HasSubstr("name one with --depth-weights")));
}

}  // namespace
}  // namespace oraclegs
