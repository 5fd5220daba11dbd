#include "oraclegs/validate/pick.h"

#include <gtest/gtest.h>

#include <cmath>

#include "oraclegs/core/error.h"

namespace oraclegs {
namespace {

Proposal Flat(const std::string& source, float value) {
  Proposal p{"t", source, {}, {2, 1, 3, std::vector<float>(6, value)}};
  p.camera.width = 2, p.camera.height = 1;
  p.inv_depth = {value, value};
  p.provenance = {static_cast<uint16_t>(source == "warp" ? 1 : 2), 0};
  return p;
}

TEST(Pick, TakesTheMostConfidentCandidateAtEachPixel) {
  const Validated v = Pick({Flat("warp", 0.f), Flat("proxies", 1.f)}, {{0.9f, 0.1f}, {0.2f, 0.6f}}, PickRule::kPixel);
  EXPECT_EQ(v.proposal.rgb.data, (std::vector<float>{0, 0, 0, 1, 1, 1}));
  EXPECT_EQ(v.confidence, (ConfidenceMap{0.9f, 0.6f}));
  EXPECT_EQ(v.proposal.inv_depth, (std::vector<float>{0, 1}));
  EXPECT_EQ(v.proposal.provenance, (std::vector<uint16_t>{1, 0}));
  EXPECT_EQ(v.proposal.source, kMixed);
  EXPECT_FLOAT_EQ(v.proposal.spread[0], std::sqrt(0.5f));
}

TEST(Pick, TakesTheMostConfidentImageWhole) {
  const Validated v = Pick({Flat("warp", 0.f), Flat("proxies", 1.f)}, {{0.9f, 0.1f}, {0.5f, 0.6f}}, PickRule::kView);
  EXPECT_EQ(v.proposal.source, "proxies");
  EXPECT_EQ(v.confidence, (ConfidenceMap{0.5f, 0.6f}));
}

TEST(Pick, BlendsByExpectedError) {
  const Validated v = Pick({Flat("warp", 0.f), Flat("proxies", 1.f)}, {{0.9f, 0.5f}, {0.3f, 0.5f}}, PickRule::kBlend);
  EXPECT_LT(v.proposal.rgb.data[0], 0.15f);
  EXPECT_GT(v.proposal.rgb.data[0], 0.02f);
  EXPECT_FLOAT_EQ(v.proposal.rgb.data[3], 0.5f);
  EXPECT_GT(v.confidence[0], 0.8f);
  EXPECT_FLOAT_EQ(v.confidence[1], 0.5f);
}

TEST(Pick, KeepsASingleCandidate) {
  for (const PickRule rule : {PickRule::kBlend, PickRule::kPixel, PickRule::kView}) {
    const Validated v = Pick({Flat("folder", 0.3f)}, {{0.7f, 0.2f}}, rule);
    EXPECT_EQ(v.proposal.rgb.data, std::vector<float>(6, 0.3f));
    EXPECT_EQ(v.proposal.source, "folder");
    EXPECT_EQ(v.confidence, (ConfidenceMap{0.7f, 0.2f}));
  }
}

TEST(Pick, RefusesSizesThatDiffer) {
  EXPECT_THROW(Pick({}, {}, PickRule::kBlend), ShapeError);
  EXPECT_THROW(Pick({Flat("warp", 0)}, {{0.5f, 0.5f}, {0.5f, 0.5f}}, PickRule::kBlend), ShapeError);
  EXPECT_THROW(Pick({Flat("warp", 0), Flat("proxies", 0)}, {{0.5f, 0.5f}, {0.5f}}, PickRule::kBlend), ShapeError);
}

}  // namespace
}  // namespace oraclegs
