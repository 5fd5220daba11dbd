#include "oraclegs/validate/vggt_oracle.h"

#include <utility>

#include "oraclegs/core/interrupt.h"
#include "oraclegs/validate/view_chunks.h"

namespace oraclegs {

VggtOracle::VggtOracle(std::unique_ptr<AttentionNetwork> network, VggtOracleOptions options,
                       const std::vector<LoadedView>& views)
    : network_(std::move(network)), options_(std::move(options)), views_(views) {
  if (options_.chunk == 0) throw ShapeError("VggtOracle: chunks of no proposal");
}

std::vector<ConfidenceMap> VggtOracle::Predict(const std::vector<Query>& queries) const {
  std::vector<ConfidenceMap> maps(queries.size());
  for (const ViewChunk& chunk : PlanChunks(queries, views_, options_.chunk)) {
    ThrowIfInterrupted();
    std::vector<Image8> proposals;
    for (const size_t m : chunk.members) proposals.push_back(ToImage8(queries[m].proposal.rgb));
    const Buffer<float> confidence = network_->Confidence(ToImage8(views_[chunk.reference].rgb), proposals);
    for (size_t i = 0; i < chunk.members.size(); ++i) {
      const auto row = static_cast<int64_t>(i);
      const std::span<float> map = confidence.Rows(row, row + 1).span();
      maps[chunk.members[i]].assign(map.begin(), map.end());
    }
    if (options_.on_pass) options_.on_pass(chunk.members.size());
  }
  return maps;
}

}  // namespace oraclegs
