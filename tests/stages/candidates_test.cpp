#include "oraclegs/stages/candidates.h"

#include <gtest/gtest.h>

namespace oraclegs {
namespace {

std::vector<Proposal> Candidates(const std::string& name, size_t pixels) {
  Proposal p{name, "warp", {}, {static_cast<int>(pixels), 1, 3, std::vector<float>(3 * pixels, 0.1f)}};
  p.provenance.assign(pixels, 7);
  return {p};
}

TEST(CandidateStore, GivesBackTheSameFloatsOnce) {
  CandidateStore store(1000);
  store.Keep("a", Candidates("a", 10));
  EXPECT_EQ(store.bytes(), 30 * sizeof(float) + 10 * sizeof(uint16_t));
  const auto kept = store.Take("a");
  ASSERT_TRUE(kept.has_value());
  EXPECT_EQ(kept->front().rgb.data, Candidates("a", 10).front().rgb.data);
  EXPECT_EQ(kept->front().provenance, Candidates("a", 10).front().provenance);
  EXPECT_EQ(store.bytes(), 0u);
  EXPECT_FALSE(store.Take("a").has_value());
}

TEST(CandidateStore, ForgetsWhatDoesNotFit) {
  CandidateStore store(200);
  store.Keep("a", Candidates("a", 10));
  store.Keep("b", Candidates("b", 10));
  EXPECT_TRUE(store.Take("a").has_value());
  EXPECT_FALSE(store.Take("b").has_value());
  store.Keep("c", Candidates("c", 10));
  EXPECT_TRUE(store.Take("c").has_value()) << "there is room again";
}

TEST(CandidateStore, RemembersThatATargetHasNone) {
  CandidateStore store(0);
  store.Keep("a", {});
  ASSERT_TRUE(store.Take("a").has_value());
}

}  // namespace
}  // namespace oraclegs
