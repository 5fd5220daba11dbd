#include "oraclegs/pipeline/settings/oracle_choice.h"

#include "networks/vggt_fixture.h"
#include "pipeline/weights.h"

namespace oraclegs {
namespace {

using testing::AllOf;
using testing::ElementsAre;
using testing::HasSubstr;

RunOptions With(const std::string& oracle) {
  RunOptions options;
  options.validate.oracle = oracle;
  return options;
}

TEST(ChooseOracle, AutoFollowsTheWeightsAndSaysSo) {
  const TempDir dir;
  const ModelsAt models(dir / "models");
  Recorder recorder;
  EXPECT_EQ(ChooseOracle(With("auto")).oracle, "consistency");
  TellOracle(With("auto"), ChooseOracle(With("auto")), recorder.AsListener());
  EXPECT_THAT(recorder.notes, ElementsAre(AllOf(HasSubstr("without VGGT"), HasSubstr("oraclegs models fetch vggt"))));
  const std::string before = ChooseOracle(With("auto")).Key();
  WriteTinyVggt(dir / "models" / "vggt" / "model.safetensors");
  const OracleChoice choice = ChooseOracle(With("auto"));
  EXPECT_EQ(choice.oracle, "vggt+consistency");
  EXPECT_NE(choice.Key(), before);
  TellOracle(With("auto"), choice, recorder.AsListener());
  EXPECT_THAT(recorder.notes.back(), HasSubstr("VGGT-1B with the photographs"));
}

TEST(ChooseOracle, WhatIsNamedIsTakenWithoutAWord) {
  const TempDir dir;
  const ModelsAt models(dir / "models");
  Recorder recorder;
  for (const char* word : {"consistency", "uniform"}) {
    EXPECT_EQ(ChooseOracle(With(word)).oracle, word);
    TellOracle(With(word), ChooseOracle(With(word)), recorder.AsListener());
  }
  EXPECT_TRUE(recorder.notes.empty());
  for (const char* word : {"vggt", "vggt+consistency"}) {
    EXPECT_THAT(MessageOf<InputError>([&] { ChooseOracle(With(word)); }),
                AllOf(HasSubstr(std::string("--oracle ") + word + " needs"), HasSubstr("models fetch vggt")));
  }
  RunOptions named = With("vggt");
  named.weights.vggt_weights = WriteTinyVggt(dir / "named.safetensors");
  EXPECT_EQ(ChooseOracle(named).weights->path, dir / "named.safetensors");
}

TEST(ChooseChunk, IsEightOrWhatTheMemoryHolds) {
  const auto bytes = [](int64_t chunk) { return (10 + chunk) << 20; };
  const auto mebibytes = [](uint64_t n) { return n << 20; };
  Recorder recorder;
  EXPECT_EQ(ChooseChunk(bytes, 0, mebibytes(100), recorder.AsListener()), 8u);
  EXPECT_EQ(ChooseChunk(bytes, 0, 0, recorder.AsListener()), 8u);  // nobody knows
  EXPECT_EQ(ChooseChunk(bytes, 20, mebibytes(100), recorder.AsListener()), 20u);
  EXPECT_TRUE(recorder.warnings.empty());
  EXPECT_EQ(ChooseChunk(bytes, 0, mebibytes(13), recorder.AsListener()), 3u);
  EXPECT_THAT(recorder.warnings,
              ElementsAre(AllOf(HasSubstr("3 proposals at a time, not 8"), HasSubstr("--oracle-chunk 3"))));
  EXPECT_EQ(ChooseChunk(bytes, 20, mebibytes(13), recorder.AsListener()), 20u);
  EXPECT_THAT(recorder.warnings.back(), AllOf(HasSubstr("--oracle-chunk 20"), HasSubstr("are free")));
  EXPECT_THAT(MessageOf<RunError>([&] { ChooseChunk(bytes, 0, mebibytes(10), Silent()); }),
              AllOf(HasSubstr("for one proposal beside a photograph"), HasSubstr("--oracle consistency")));
}

}  // namespace
}  // namespace oraclegs
