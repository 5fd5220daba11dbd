#include "oraclegs/propose/proposers.h"

#include <gtest/gtest.h>

#include "depth/surfaces.h"

namespace oraclegs {
namespace {

/// Answers with a black image; of held-out views only the first two.
class BlackProposer : public Proposer {
 public:
  explicit BlackProposer(std::string name) : name_(std::move(name)) {}
  std::string name() const override { return name_; }
  std::optional<Proposal> Propose(const Target& target, std::optional<int> held_out) const override {
    if (held_out && *held_out > 1) return std::nullopt;
    return Proposal{target.name, name_, target.camera, {2, 2, 3, std::vector<float>(12)}};
  }

 private:
  std::string name_;
};

TEST(Proposers, AskEachForEachTarget) {
  const TexturedPlane plane;
  std::vector<LoadedView> views;
  std::vector<DepthMap> maps;
  for (const Camera& camera : Arc(5, 8)) {
    views.push_back(plane.Take(camera, fmt::format("p{}", views.size())));
    maps.push_back(TrueDepth(views.back(), plane, 0.9f));
  }
  const auto warper = [&] { return std::make_unique<Warper>(WarpSources{views, maps}); };
  std::unique_ptr<Warper> shared = warper();
  std::vector<AskedProposer> members;
  members.push_back({std::make_unique<WarpProposer>(*shared)});
  members.push_back({.proposer = std::make_unique<BlackProposer>("proxies"), .renders = true});
  members.push_back({.proposer = std::make_unique<BlackProposer>("teacher"), .paints = false});
  const Proposers all(std::move(shared), std::move(members));
  const Target first{"first", views[0].camera}, third{"third", views[2].camera};
  const auto candidates = all.Ask({first, third, third}, {0, std::nullopt, 2});
  ASSERT_EQ(candidates.size(), 3u);
  ASSERT_EQ(candidates[0].size(), 3u);
  EXPECT_EQ(candidates[0][0].source, "warp");
  EXPECT_EQ(candidates[0][1].source, "proxies");
  EXPECT_EQ(candidates[0][2].source, "teacher");
  EXPECT_EQ(candidates[0][1].name, "first");
  EXPECT_EQ(candidates[1].size(), 2u) << "one does not paint";
  EXPECT_EQ(candidates[2].size(), 1u) << "the others cannot hold out the third view";
  EXPECT_TRUE(all.has_proxy_models());
  EXPECT_EQ(all.ProxyRender(first)->source, "proxies");
  const Proposers none(warper(), {});
  EXPECT_FALSE(none.has_proxy_models());
  EXPECT_FALSE(none.ProxyRender(first).has_value());
  EXPECT_TRUE(none.Ask({first})[0].empty());
}

}  // namespace
}  // namespace oraclegs
