#include "oraclegs/core/option_table.h"

#include <gmock/gmock.h>

#include <nlohmann/json.hpp>

#include "support/errors.h"

namespace oraclegs {

enum class Finish { kMatte, kGlossy };
template <>
struct EnumWords<Finish> {
  static constexpr EnumWord<Finish> kWords[] = {{Finish::kMatte, "matte"}, {Finish::kGlossy, "glossy"}};
};

namespace {

using nlohmann::json;

struct PaintOptions {
  int coats = 2;
  bool primer = false;
  Auto<Finish> finish = {};
  Auto<std::string> walls = {};
  double share = 0.5;

  template <class Self, class V>
  static void Visit(Self& self, V&& visit) {
    visit("coats", self.coats, "Coats of paint", Range{1, 5});
    visit("primer", self.primer, "Prime first");
    visit("finish", self.finish, "Look of the last coat");
    visit("walls", self.walls, "Walls to paint", WordList{{"north", "south"}});
    visit("share", self.share, "Share of the walls", Range{0, 1}, Tier::kSetting);
  }
};

TEST(OptionTable, SetsFieldsFromTextsAndJson) {
  PaintOptions paint;
  OptionTable table;
  table.AddAll(&paint);
  EXPECT_THAT(table.Names(), testing::ElementsAre("coats", "primer", "finish", "walls", "share"));
  EXPECT_FALSE(table.IsGiven("coats"));
  table.Find("coats")->Set(std::string("3"));
  table.Find("primer")->Set(json(true));
  table.Find("finish")->Set(json("glossy"));
  table.Find("share")->Set(json(0.25));
  EXPECT_EQ(paint.coats, 3);
  EXPECT_TRUE(paint.primer);
  EXPECT_EQ(paint.finish, Finish::kGlossy);
  EXPECT_EQ(paint.share, 0.25);
  EXPECT_TRUE(table.IsGiven("coats"));
  EXPECT_FALSE(table.IsGiven("color"));
  EXPECT_EQ(table.Find("color"), nullptr);
}

TEST(WordsOf, AreThoseOfTheTypeOrOfTheDeclaration) {
  using testing::ElementsAre;
  EXPECT_THAT(WordsOf<Auto<Finish>>(), ElementsAre("auto", "matte", "glossy"));
  EXPECT_THAT((WordsOf<Auto<std::string>>(Tier::kFlag, WordList{{"north", "south"}})),
              ElementsAre("auto", "north", "south"));
  EXPECT_THAT(WordsOf<std::string>(Tier::kFlag), testing::IsEmpty());
}

TEST(OptionTable, TellsFlagsFromSettings) {
  PaintOptions paint;
  OptionTable table;
  table.AddAll(&paint);
  EXPECT_EQ(table.Find("finish")->tier(), Tier::kFlag);
  EXPECT_EQ(table.Find("share")->tier(), Tier::kSetting);
  EXPECT_EQ(ListOptions(paint).back().tier, Tier::kSetting);
}

TEST(OptionTable, NamesWhatDoesNotFit) {
  PaintOptions paint;
  OptionTable table;
  table.AddAll(&paint);
  const auto message = [&](const char* name, const json& value) {
    return MessageOf<UsageError>([&] { table.Find(name)->Set(value); });
  };
  EXPECT_EQ(message("coats", "many"), "--coats is 'many', must be a whole number");
  EXPECT_EQ(message("share", "half"), "--set share is 'half', must be a number");
  EXPECT_EQ(message("finish", "glosy"),
            "--finish is 'glosy', must be one of: auto, matte, glossy; did you mean 'glossy'?");
  EXPECT_EQ(message("primer", "on"), "--primer is 'on', must be true or false");
  EXPECT_EQ(message("coats", nullptr), "--coats is null, must be a number, a text, or true or false");
  EXPECT_FALSE(table.IsGiven("coats"));
  paint.share = 7;
  EXPECT_EQ(MessageOf<UsageError>([&] { CheckOptions(paint); }), "--set share is 7, must be in 0 .. 1");
}

TEST(OptionTable, AppendsToAList) {
  std::vector<std::string> names = {"a"};
  OptionTable table;
  TableOption& option = table.Add("names", &names);
  option.Set(std::string("b"));
  option.Set(json("c, d"));
  EXPECT_THAT(names, testing::ElementsAre("a", "b", "c, d"));
}

TEST(OptionTable, FindsTheFirstOfTwoOfOneName) {
  int own = 0, other = 0;
  OptionTable table;
  table.Add("views", &own);
  table.Add("views", &other).LeaveToFiles();
  table.Find("views")->Set(std::string("4"));
  EXPECT_EQ(own, 4);
  EXPECT_EQ(other, 0);
  EXPECT_FALSE(table.Find("views")->of_files_alone());
}

}  // namespace
}  // namespace oraclegs
