#include "oraclegs/weights/folder.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "environment.h"
#include "oraclegs/core/error.h"
#include "oraclegs/core/files.h"
#include "support/temp_dir.h"

namespace oraclegs {
namespace {

using testing::StrEq;
using testing::ThrowsMessage;

TEST(WeightsFolder, IsTheVariableOrTheCache) {
  const ScopedVariable home("HOME", "/home/me");
  {
    const ScopedVariable chosen("ORACLEGS_MODELS", "/disk/models");
    EXPECT_EQ(WeightsFolder(), "/disk/models");
    EXPECT_EQ(FetchedFile("seva"), "/disk/models/seva/model.safetensors");
  }
  const ScopedVariable none("ORACLEGS_MODELS", std::nullopt);
  EXPECT_EQ(WeightsFolder(), "/home/me/.cache/oraclegs");
  const ScopedVariable homeless("HOME", std::nullopt);
  EXPECT_THAT(
      [] { WeightsFolder(); },
      ThrowsMessage<UsageError>(StrEq("HOME is not set; set ORACLEGS_MODELS to the folder for the weights of models")));
}

TEST(RequireWeights, PrefersTheFetchedFile) {
  const TempDir dir;
  const ScopedVariable chosen("ORACLEGS_MODELS", dir.path().string());
  EXPECT_EQ(LocateWeights("vggt"), std::nullopt);
  const auto by_hand = dir / "vggt.safetensors", index = dir / "vggt/model.safetensors.index.json",
             fetched = dir / "vggt/model.safetensors";
  for (const auto& path : {by_hand, index, fetched}) {
    WriteFileAtomically(path, "x");
    EXPECT_EQ(RequireWeights("vggt"), path);
  }
}

TEST(RequireWeights, NamesTheFetchCommand) {
  const ScopedVariable chosen("ORACLEGS_MODELS", "/nowhere");
  EXPECT_THAT([] { RequireWeights("seva"); },
              ThrowsMessage<InputError>(StrEq("/nowhere/seva/model.safetensors: the weights of seva are not here; "
                                              "`oraclegs models fetch seva` brings them")));
  EXPECT_THROW(RequireWeights("none"), UsageError);
}

TEST(RequireFirstWeights, TakesTheFirstThatIsHere) {
  const TempDir dir;
  const ScopedVariable chosen("ORACLEGS_MODELS", dir.path().string());
  const std::vector<std::string> names = {"vggt", "vggt-commercial"};
  EXPECT_THAT([&] { RequireFirstWeights(names); },
              ThrowsMessage<InputError>(testing::HasSubstr("the weights of vggt or vggt-commercial are not here")));
  WriteFileAtomically(dir / "vggt-commercial.safetensors", "x");
  EXPECT_EQ(RequireFirstWeights(names).name, "vggt-commercial");
  WriteFileAtomically(dir / "vggt.safetensors", "x");
  EXPECT_EQ(RequireFirstWeights(names).name, "vggt");
}

}  // namespace
}  // namespace oraclegs
