#include "oraclegs/experiments/bench/suites.h"

#include <gmock/gmock.h>

#include "oraclegs/core/files.h"
#include "oraclegs/core/text.h"
#include "support/errors.h"
#include "support/temp_dir.h"

namespace oraclegs {
namespace {

using testing::AllOf;
using testing::ElementsAre;
using testing::HasSubstr;

std::vector<std::string> NamesIn(const std::vector<SuiteScene>& scenes) {
  std::vector<std::string> names;
  for (const SuiteScene& scene : scenes) names.push_back(scene.name);
  return names;
}

/// `name = value` of a preset, without quotes and comment; "" where it has none.
std::string PresetValue(const std::string& preset, const std::string& name) {
  for (const std::string& line : SplitTrimmed(ReadFile(ORACLEGS_PRESETS_DIR "/" + preset + ".toml"), '\n')) {
    if (!line.starts_with(name + " = ")) continue;
    const std::string value = SplitTrimmed(line.substr(name.size() + 3), '#')[0];
    return value.front() == '"' ? value.substr(1, value.size() - 2) : value;
  }
  return "";
}

TEST(Suites, HaveTheImagesOfTheirPresets) {
  for (const Suite& suite : Suites()) {
    for (const int views : suite.views) {
      std::string preset = suite.preset;
      const RunArguments protocol = suite.protocol(views);
      preset.replace(preset.find("{}"), 2, std::to_string(views));
      for (const char* name : {"views", "view-steps", "test-every", "train-views", "test-views", "downscale",
                               "smaller-copies", "background", "resize"}) {
        const std::string* value = FindArgument(protocol, name);
        EXPECT_EQ(value ? *value : "", PresetValue(preset, name)) << preset << " " << name;
      }
      EXPECT_NO_THROW(OptionsOf(protocol));
    }
  }
}

TEST(PaperPreset, FollowsSuiteAndViews) {
  EXPECT_EQ(PaperPreset(FindSuite("mipnerf360"), 24), "paper-mipnerf360-24");
  EXPECT_EQ(PaperPreset(FindSuite("blender"), 8), "paper-blender-8");
  EXPECT_EQ(PaperPreset(FindSuite("llff"), 3), "paper") << "no scenes of the paper";
  EXPECT_THAT(MessageOf<UsageError>([] { PaperPreset(FindSuite("mipnerf360"), 16); }),
              AllOf(HasSubstr("Mip-NeRF 360"), HasSubstr("12 and 24 views, not of 16")));
}

TEST(ViewsOf, AreThoseOfThePresetAlone) {
  const RunArguments preset = {{"views", "12"}};
  const Suite suite = FindSuite("mipnerf360");
  EXPECT_THAT(ViewsOf(suite, "", preset), ElementsAre(12));
  EXPECT_THAT(ViewsOf(suite, "12", preset), ElementsAre(12));
  EXPECT_THAT(MessageOf<UsageError>([&] { ViewsOf(suite, "12,24", preset); }),
              AllOf(HasSubstr("names 24"), HasSubstr("--preset are for 12")));
}

TEST(FindSuite, RefusesWhatIsNeitherNameNorFolder) {
  EXPECT_EQ(FindSuite("llff").scenes.size(), 8u);
  EXPECT_EQ(FindSuite("mipnerf360").scenes.size(), 7u);
  EXPECT_EQ(FindSuite("dtu").scenes.size(), 15u);
  EXPECT_THAT(MessageOf<UsageError>([] { FindSuite("blendr"); }),
              AllOf(HasSubstr("mipnerf360, blender"), HasSubstr("did you mean 'blender'?")));
  EXPECT_THAT(MessageOf<UsageError>([] { FindSuite(""); }), HasSubstr("--suite is missing"));
}

TEST(ScenesOf, FindsTheFolderBelowData) {
  const TempDir dir;
  WriteText(dir / "nerf_synthetic/lego/transforms_train.json", "{}");
  const Suite blender = FindSuite("blender");
  for (const auto& data : {dir.path(), dir / "nerf_synthetic"}) {
    const auto scenes = ScenesOf(blender, "blender", data);
    ASSERT_EQ(scenes.size(), 8u) << "those that are missing, too";
    EXPECT_EQ(scenes[4].name, "lego");
    EXPECT_TRUE(std::filesystem::exists(scenes[4].path)) << scenes[4].path;
  }
  EXPECT_THAT(MessageOf<InputError>([&] { ScenesOf(FindSuite("llff"), "llff", dir.path()); }),
              AllOf(HasSubstr(dir.path().string()), HasSubstr("no scene of LLFF"), HasSubstr("nerf_llff_data")));
  EXPECT_THAT(MessageOf<UsageError>([&] { ScenesOf(blender, "blender", ""); }), HasSubstr("--data is missing"));
}

TEST(ScenesOf, OfAFolderAreItsSubfoldersOrItself) {
  const TempDir dir;
  WriteText(dir / "r10/transforms.json", "{}");
  WriteText(dir / "r2/images/1.jpg", "");
  WriteText(dir / "notes/read.txt", "");
  const std::string folder = dir.path().string();
  EXPECT_THAT(NamesIn(ScenesOf(FindSuite(folder), folder, "")), ElementsAre("r2", "r10"));
  const std::string one = (dir / "r2").string() + "/";
  EXPECT_EQ(FindSuite(one).name, "r2");
  EXPECT_THAT(NamesIn(ScenesOf(FindSuite(one), one, "")), ElementsAre("r2"));
  const std::string none = (dir / "notes").string();
  EXPECT_THAT(MessageOf<InputError>([&] { ScenesOf(FindSuite(none), none, ""); }), HasSubstr("is a scene"));
  EXPECT_THAT(MessageOf<UsageError>([&] { ScenesOf(FindSuite(folder), folder, "/data"); }), HasSubstr("--data"));
}

TEST(ViewsOf, AreThoseOfTheProtocol) {
  EXPECT_THAT(ViewsOf(FindSuite("mipnerf360"), ""), ElementsAre(12, 24));
  EXPECT_THAT(ViewsOf(FindSuite("mipnerf360"), "24,6,24"), ElementsAre(6, 24));
  EXPECT_THAT(MessageOf<UsageError>([] { ViewsOf(FindSuite("dtu"), "3,5"); }), HasSubstr("has 3, 6, 9"));
  EXPECT_THAT(MessageOf<UsageError>([] { ViewsOf(FindSuite("llff"), "lots"); }), HasSubstr("'lots'"));
  EXPECT_THAT(MessageOf<UsageError>([] { ViewsOf(FindSuite("llff"), "1"); }), HasSubstr("--views names 1"));
}

TEST(KeepsProtocol, LooksAtImagesAndTheirSizeAlone) {
  const Suite llff = FindSuite("llff");
  EXPECT_TRUE(KeepsProtocol(llff, {3, 6}, {{"iterations", "10"}, {"init", "random"}, {"downscale", "8"}}));
  EXPECT_FALSE(KeepsProtocol(llff, {3}, {{"downscale", "4"}}));
  EXPECT_FALSE(KeepsProtocol(llff, {3}, {{"test-views", ":0"}}));
  EXPECT_FALSE(KeepsProtocol(llff, {3}, {{"max-size", "200"}}));
}

TEST(KeepsProtocol, LooksAtTheImagesOfEachNumberOfViews) {
  const Suite dtu = FindSuite("dtu");
  const RunArguments three = dtu.protocol(3), six = dtu.protocol(6);
  EXPECT_TRUE(KeepsProtocol(dtu, {3}, three));
  EXPECT_TRUE(KeepsProtocol(dtu, {6}, six));
  EXPECT_FALSE(KeepsProtocol(dtu, {6}, three));
  EXPECT_FALSE(KeepsProtocol(dtu, {3, 6, 9}, three)) << "two of them train on other images";
}

TEST(RequireOneList, RefusesOneListForSeveralNumbersOfViews) {
  const Suite dtu = FindSuite("dtu");
  EXPECT_THAT(MessageOf<UsageError>([&] {
                RequireOneList(dtu, {3, 6, 9}, dtu.protocol(3));
              }),
              AllOf(HasSubstr("--train-views"), HasSubstr("3, 6, 9 views"), HasSubstr("--views")));
  RequireOneList(dtu, {6}, dtu.protocol(6));
  RequireOneList(dtu, {3, 6, 9}, {{"downscale", "8"}});
  RequireOneList(FindSuite("llff"), {3, 6}, {{"train-views", ":0,:2,:4,:6,:8,:10"}});  // --views picks of the list
}

}  // namespace
}  // namespace oraclegs
