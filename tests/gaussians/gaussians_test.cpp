#include "oraclegs/gaussians/gaussians.h"

#include <gtest/gtest.h>

#include "support/buffers.h"

namespace oraclegs {
namespace {

TEST(Gaussians, PassesItsCheckWhenNew) {
  for (const int64_t n : {0, 1, 7}) {
    const Gaussians g = Gaussians::Zeros(n);
    g.Check("test");
    Gaussians::Empty(n).Check("test");
    EXPECT_EQ(g.size(), n);
    g.ForEach([](const char*, const Buffer<float>& t) { EXPECT_TRUE((Flat(t) == 0).all()); });
  }
  EXPECT_EQ(Gaussians().size(), 0);
}

TEST(Gaussians, HasNamesInTheOrderOfTheCheckpoint) {
  std::vector<std::string> names;
  Gaussians::Zeros(2).ForEach([&](const char* name, const Buffer<float>&) { names.push_back(name); });
  EXPECT_EQ(names, (std::vector<std::string>{"means", "log_scales", "quats", "opacity_logits", "sh"}));
}

TEST(Gaussians, CheckNamesTheBuffer) {
  const auto message = [](const Gaussians& g) -> std::string {
    try {
      g.Check("Caller");
    } catch (const ShapeError& e) {
      return e.what();
    }
    return "no error";
  };
  Gaussians g = Gaussians::Zeros(5);
  g.quats = Buffer<float>::Zeros({5, 3});
  EXPECT_NE(message(g).find("Caller: quats is [5, 3]"), std::string::npos) << message(g);
  g = Gaussians::Zeros(5);
  g.sh = Buffer<float>::Zeros({4, 16, 3});
  EXPECT_NE(message(g).find("Caller: sh is [4, 16, 3]"), std::string::npos);
  g = Gaussians::Zeros(5);
  g.means = Buffer<float>::Zeros({5});
  EXPECT_NE(message(g).find("means"), std::string::npos);
  EXPECT_NE(message(Gaussians()).find("undefined"), std::string::npos);
}

TEST(AddRows, AddsTheRowsThatItIsToldTo) {
  const Gaussians from = Gaussians::Zeros(5), to = Gaussians::Zeros(2);
  from.ForEach([](const char*, const Buffer<float>& t) {
    for (int64_t i = 0; i < t.count(); ++i) t[i] = static_cast<float>(i / t.shape().row());  // the number of the row
  });
  to.ForEach([](const char*, const Buffer<float>& t) { std::fill_n(t.data(), t.count(), 0.5f); });
  AddRows(from, 3, 5, 12, to.Rows());
  to.ForEach([](const char* name, const Buffer<float>& t) {
    const int64_t row = t.shape().row();
    for (int64_t i = 0; i < t.count(); ++i) {
      const float added = i % row < 12 ? 3 + static_cast<float>(i / row) : 0;
      EXPECT_EQ(t[i], 0.5f + added) << name << " " << i;
    }
  });
}

}  // namespace
}  // namespace oraclegs
