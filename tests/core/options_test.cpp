#include "oraclegs/core/options.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <nlohmann/json.hpp>

namespace oraclegs {

enum class Order { kName, kTime };
template <>
struct EnumWords<Order> {
  static constexpr EnumWord<Order> kWords[] = {{Order::kName, "name"}, {Order::kTime, "time"}};
};

namespace {

struct TestOptions {
  int views = 12;
  double rate = 0.5;
  Order order = Order::kName;
  Auto<Order> chosen = {};
  Auto<double> scale = {};
  bool fast = false;
  std::filesystem::path folder = "out";
  std::vector<std::string> names = {"a", "b"};

  template <class Self, class V>
  static void Visit(Self& self, V&& visit) {
    visit("views", self.views, "Training views", Range{0, 100});
    visit("rate", self.rate, "Learning rate", Range{0, 1});
    visit("order", self.order, "Order of the views");
    visit("chosen", self.chosen, "Another order");
    visit("scale", self.scale, "Scale", Range{0, 10});
    visit("fast", self.fast, "Be fast");
    visit("folder", self.folder, "Where to write");
    visit("names", self.names, "Names");
  }
};

template <class Body>
std::string UsageMessage(const Body& body) {
  try {
    body();
  } catch (const UsageError& error) {
    return error.what();
  }
  return "";
}

std::string Complaint(const TestOptions& options) {
  return UsageMessage([&] { CheckOptions(options); });
}

TEST(CheckOptions, AcceptsDefaultsAndBounds) {
  EXPECT_EQ(Complaint({}), "");
  EXPECT_EQ(Complaint({.views = 0, .rate = 1}), "");
  EXPECT_EQ(Complaint({.views = 100, .rate = 0}), "");
}

TEST(CheckOptions, NamesOptionValueAndRange) {
  EXPECT_EQ(Complaint({.views = -3}), "--views is -3, must be in 0 .. 100");
  EXPECT_EQ(Complaint({.views = 101}), "--views is 101, must be in 0 .. 100");
  EXPECT_EQ(Complaint({.rate = 1.5}), "--rate is 1.5, must be in 0 .. 1");
}

TEST(CheckOptions, RefusesNan) { EXPECT_EQ(Complaint({.rate = std::nan("")}), "--rate is nan, must be in 0 .. 1"); }

TEST(CheckOptions, ChecksTheRangeOfAGivenAutoOnly) {
  EXPECT_EQ(Complaint({.scale = {}}), "");
  EXPECT_EQ(Complaint({.scale = 11.0}), "--scale is 11, must be in 0 .. 10");
}

TEST(SetOption, ReadsEachType) {
  TestOptions options;
  SetOption("views", "7", &options.views);
  SetOption("rate", "0.25", &options.rate);
  SetOption("order", "time", &options.order);
  SetOption("chosen", "time", &options.chosen);
  SetOption("scale", "2.5", &options.scale);
  SetOption("fast", "true", &options.fast);
  SetOption("folder", "a b", &options.folder);
  EXPECT_EQ(options.views, 7);
  EXPECT_EQ(options.rate, 0.25);
  EXPECT_EQ(options.order, Order::kTime);
  EXPECT_EQ(options.chosen.value(), Order::kTime);
  EXPECT_EQ(options.scale.value(), 2.5);
  EXPECT_TRUE(options.fast);
  EXPECT_EQ(options.folder, "a b");
}

TEST(SetOption, ReadsAutoAsNoValue) {
  Auto<double> scale = 3.0;
  SetOption("scale", "auto", &scale);
  EXPECT_TRUE(scale.is_auto());
  EXPECT_EQ(scale.ValueOr(4), 4);
}

TEST(SetOption, NamesTheKnownWords) {
  TestOptions options;
  EXPECT_EQ(UsageMessage([&] { SetOption("order", "size", &options.order); }),
            "--order is 'size', must be one of: name, time");
  EXPECT_EQ(UsageMessage([&] { SetOption("chosen", "size", &options.chosen); }),
            "--chosen is 'size', must be one of: auto, name, time");
}

TEST(SetOption, RefusesTextThatIsNoNumber) {
  int views = 3;
  for (const char* text : {"", "x", "1x"}) {
    EXPECT_EQ(UsageMessage([&] { SetOption("views", text, &views); }),
              fmt::format("--views is '{}', must be a whole number", text));
  }
  EXPECT_EQ(UsageMessage([&] { SetOption("views", "99999999999999999999", &views); }),
            "--views is '99999999999999999999', which is too large");
  EXPECT_EQ(views, 3);
}

TEST(OptionsToJson, HoldsEveryField) {
  const nlohmann::json expected = {{"views", 3},   {"rate", 0.5},   {"order", "name"}, {"chosen", "auto"},
                                   {"scale", 2.5}, {"fast", false}, {"folder", "a/b"}, {"names", {"a", "b"}}};
  EXPECT_EQ(OptionsToJson(TestOptions{.views = 3, .scale = 2.5, .folder = "a/b"}), expected);
}

TEST(ListOptions, KeepsTheOrderOfVisit) {
  std::vector<std::string> names, values;
  for (const NamedOption& option : ListOptions(TestOptions{})) {
    names.push_back(option.name);
    values.push_back(TextOf(option.value));
  }
  EXPECT_THAT(names, testing::ElementsAre("views", "rate", "order", "chosen", "scale", "fast", "folder", "names"));
  EXPECT_THAT(values, testing::ElementsAre("12", "0.5", "name", "auto", "auto", "false", "out", "a, b"));
}

}  // namespace
}  // namespace oraclegs
