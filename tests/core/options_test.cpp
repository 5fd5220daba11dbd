#include "oraclegs/core/options.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

namespace oraclegs {
namespace {

struct TestOptions {
  int views = 12;
  double rate = 0.5;
  std::string order = "name";
  bool fast = false;
  std::filesystem::path folder = "out";
  std::vector<std::string> names = {"a", "b"};

  template <class Self, class V>
  static void Visit(Self& self, V&& visit) {
    visit("views", self.views, "Training views", Range{0, 100});
    visit("rate", self.rate, "Learning rate", Range{0, 1});
    visit("order", self.order, "Order of the views", Choice{{"name", "time"}});
    visit("fast", self.fast, "Be fast");
    visit("folder", self.folder, "Where to write");
    visit("names", self.names, "Names");
  }
};

std::string Complaint(const TestOptions& options) {
  try {
    CheckOptions(options);
  } catch (const UsageError& error) {
    return error.what();
  }
  return "";
}

TEST(Options, DefaultsAndBoundsPass) {
  EXPECT_EQ(Complaint({}), "");
  EXPECT_EQ(Complaint({.views = 0, .rate = 1}), "");
  EXPECT_EQ(Complaint({.views = 100, .rate = 0}), "");
}

TEST(Options, NumberOutOfRangeNamesOptionValueAndRange) {
  EXPECT_EQ(Complaint({.views = -3}), "--views is -3, must be in 0 .. 100");
  EXPECT_EQ(Complaint({.views = 101}), "--views is 101, must be in 0 .. 100");
  EXPECT_EQ(Complaint({.rate = 1.5}), "--rate is 1.5, must be in 0 .. 1");
}

TEST(Options, NotANumberIsOutOfEveryRange) {
  EXPECT_EQ(Complaint({.rate = std::nan("")}), "--rate is nan, must be in 0 .. 1");
}

TEST(Options, UnknownWordNamesTheKnownOnes) {
  EXPECT_EQ(Complaint({.order = "size"}), "--order is 'size', must be one of: name, time");
}

TEST(Options, JsonHoldsEveryField) {
  const nlohmann::json expected = {{"views", 3},    {"rate", 0.5},     {"order", "name"},
                                   {"fast", false}, {"folder", "a/b"}, {"names", {"a", "b"}}};
  EXPECT_EQ(OptionsToJson(TestOptions{.views = 3, .folder = "a/b"}), expected);
}

}  // namespace
}  // namespace oraclegs
