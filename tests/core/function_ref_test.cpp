#include "oraclegs/core/function_ref.h"

#include <gtest/gtest.h>

#include <array>
#include <memory>
#include <string>

namespace oraclegs {
namespace {

int Twice(FunctionRef<int(int)> f, int x) { return f(f(x)); }

TEST(FunctionRef, CallsWhatItWasMadeFrom) {
  int calls = 0;
  std::array<int, 100> large{};  // more than std::function would hold without allocating
  large[7] = 3;
  EXPECT_EQ(Twice(
                [&calls, large](int x) {
                  ++calls;
                  return x + large[7];
                },
                10),
            16);
  EXPECT_EQ(calls, 2);
}

TEST(FunctionRef, RefersInsteadOfCopying) {
  struct Counter {
    int count = 0;
    void operator()() { ++count; }
  };
  Counter counter;
  const FunctionRef<void()> f = counter;
  const FunctionRef<void()> same = f;
  f();
  same();
  EXPECT_EQ(counter.count, 2);
}

TEST(FunctionRef, CallsConstObjectsAndPointersToFunctions) {
  const auto add_one = [](int x) { return x + 1; };
  EXPECT_EQ(Twice(add_one, 0), 2);
  int (*negate)(int) = [](int x) { return -x; };
  EXPECT_EQ(Twice(negate, 5), 5);
}

TEST(FunctionRef, ForwardsArgumentsThatOnlyMoveAndReferences) {
  const auto take = [](std::unique_ptr<int> p, std::string& out) { out = std::to_string(*p); };
  const FunctionRef<void(std::unique_ptr<int>, std::string&)> f = take;
  std::string out;
  f(std::make_unique<int>(42), out);
  EXPECT_EQ(out, "42");
}

TEST(FunctionRef, TakesOnlyWhatFits) {
  using F = FunctionRef<int(int)>;
  static_assert(std::is_constructible_v<F, int (*)(int)>);
  static_assert(!std::is_constructible_v<F, int>);
  static_assert(!std::is_constructible_v<F, std::string (*)(int)>);
  static_assert(!std::is_default_constructible_v<F>);
}

}  // namespace
}  // namespace oraclegs
