#include "oraclegs/run/network_needs.h"

#include <nlohmann/json.hpp>

#include "run/weights.h"
#include "support/network_files.h"

namespace oraclegs {
namespace {

using testing::AllOf;
using testing::HasSubstr;
using testing::StartsWith;

TEST(RequireNetworkNeeds, RefusesBeforeAnythingIsComputed) {
  SKIP_WITHOUT_NETWORKS();
  const TempDir dir;
  const ModelsAt models(dir.path());
  WriteTinyNetworks(dir.path());
  RunOptions options;
  options.propose.proposers = std::string("seva"), options.validate.oracle = OracleKind::kVggt;
  options.seva.frames = 12, options.seva.short_side = 64;
  options.image.max_size = 0;
  const Plan plan = MakePlan(options, true);
  const auto with = [&](int photos, int64_t free, const nlohmann::json& done = nlohmann::json::object()) {
    RequireNetworkNeeds(options, plan, {photos, {80, 60}}, done, [&](Device) { return free; });
  };
  constexpr int64_t kLittle = 1000, kMuch = int64_t{1} << 40;
  EXPECT_NO_THROW(with(10, kMuch));
  EXPECT_NO_THROW(with(10, 0)) << "nobody knows";
  EXPECT_THAT(MessageOf<UsageError>([&] { with(11, kMuch); }),
              AllOf(HasSubstr("11 photos leave no room"), HasSubstr("--seva-frames must be at least 13")));
  EXPECT_THAT(MessageOf<RunError>([&] { with(10, kLittle); }),
              AllOf(StartsWith("seva needs about"), HasSubstr("--set seva-precision=bfloat16")));
  EXPECT_THAT(MessageOf<RunError>([&] {
                with(10, kLittle, {{"propose", {}}});
              }),
              AllOf(StartsWith("VGGT needs about"), HasSubstr("--oracle consistency")));
  EXPECT_NO_THROW(with(11, kLittle, {{"propose", {}}, {"validate", {}}})) << "both are done";
  options.propose.proposers = std::string("warp"), options.validate.oracle = OracleKind::kConsistency;
  RequireNetworkNeeds(options, MakePlan(options, true), {11, {80, 60}}, nlohmann::json::object(),
                      [](Device) { return kLittle; });
}

}  // namespace
}  // namespace oraclegs
