#include "oraclegs/run/network_needs.h"

#include <nlohmann/json.hpp>

#include "oraclegs/networks/loader.h"
#include "oraclegs/proposers/seva.h"
#include "oraclegs/validate/calibrated_oracle.h"
#include "oraclegs/validate/vggt_oracle.h"

namespace oraclegs {
namespace {

constexpr const char* kSeva = "seva";

void RequireSeva(const RunOptions& options, int photos, PixelSize size, Device device, int64_t free) {
  if (photos + 2 > options.seva.frames) {
    throw UsageError(
        "{} photos leave no room in chunks of {} frames; --seva-frames must be at least {}, or let fewer train with "
        "--views",
        photos, options.seva.frames, photos + 2);
  }
  const ViewGeneratorRequest request{FindSevaFiles(options.weights), options.seva, device, free};
  GetNetworks().RequireMemoryToGenerate(request, {size.width, size.height});
}

void RequireVggt(const RunOptions& options, const VggtWeights& weights, PixelSize size, Device device, int64_t free) {
  const ValidateOptions& asked = options.validate;
  const auto network = GetNetworks().OpenAttention(
      weights.path, {asked.oracle_mode, AttentionLayersOf(asked), SettlePrecision(asked, device)}, device);
  Camera camera;
  camera.width = size.width, camera.height = size.height;
  const int64_t beside = asked.oracle_pass == OraclePass::kAll ? 0 : 1;
  ChooseChunk([&](int64_t images) { return network->PassBytes({camera}, images + beside); }, {asked.oracle_chunk, 1, 1},
              static_cast<uint64_t>(free), Silent());
}

}  // namespace

void RequireNetworkNeeds(const RunOptions& options, const Plan& plan, const SceneSize& scene,
                         const nlohmann::json& done, const FreeMemory& free) {
  const bool seva = plan.Uses(options, kSeva), vggt = plan.oracle.weights.has_value();
  if (!seva && !vggt) return;
  const PixelSize size = WorkingSize(scene.largest, options.image.Settled());
  const Device device = DeviceOfNetworks(GetNetworks(), plan.device, Silent());
  if (seva && !done.contains("propose")) RequireSeva(options, scene.views, size, device, free(device));
  if (vggt && !done.contains("validate")) RequireVggt(options, *plan.oracle.weights, size, device, free(device));
}

}  // namespace oraclegs
