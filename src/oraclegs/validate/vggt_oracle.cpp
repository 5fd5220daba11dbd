#include "oraclegs/validate/vggt_oracle.h"

#include <utility>

#include "oraclegs/core/interrupt.h"
#include "oraclegs/validate/view_chunks.h"

namespace oraclegs {
namespace {

ConfidenceMap MapOf(const Buffer<float>& map) { return {map.span().begin(), map.span().end()}; }

}  // namespace

VggtOracle::VggtOracle(std::unique_ptr<AttentionNetwork> network, VggtOracleOptions options,
                       const std::vector<LoadedView>& views)
    : network_(std::move(network)), options_(std::move(options)), views_(views) {
  if (options_.chunk == 0) throw ShapeError("VggtOracle: chunks of no proposal");
}

std::vector<ConfidenceMap> VggtOracle::Predict(const std::vector<Query>& queries) const {
  return options_.pass == OraclePass::kAll ? PredictShuffled(queries) : PredictChunks(queries);
}

std::vector<ConfidenceMap> VggtOracle::PredictChunks(const std::vector<Query>& queries) const {
  std::vector<ConfidenceMap> maps(queries.size());
  for (const ViewChunk& chunk : PlanChunks(queries, views_, options_.chunk)) {
    ThrowIfInterrupted();
    std::vector<Image8> images = {ToImage8(views_[chunk.reference].rgb)};
    std::vector<size_t> asked;
    for (const size_t m : chunk.members) {
      asked.push_back(images.size());
      images.push_back(ToImage8(queries[m].proposal.rgb));
    }
    const std::vector<Buffer<float>> answers = network_->Confidence(images, asked);
    for (size_t i = 0; i < answers.size(); ++i) maps[chunk.members[i]] = MapOf(answers[i]);
    if (options_.on_pass) options_.on_pass(chunk.members.size());
  }
  return maps;
}

std::vector<ConfidenceMap> VggtOracle::PredictShuffled(const std::vector<Query>& queries) const {
  for (const Query& query : queries) {
    if (query.held_out) throw ShapeError("{}: no view is held out of a pass over all", query.proposal.name);
  }
  std::vector<ConfidenceMap> maps(queries.size());
  if (queries.empty()) return maps;
  for (const std::vector<size_t>& run : ShuffledRuns(views_.size() + queries.size(), options_.chunk, options_.seed)) {
    ThrowIfInterrupted();
    std::vector<Image8> images;
    std::vector<size_t> asked, places;
    for (const size_t number : run) {
      if (number >= views_.size()) {
        asked.push_back(images.size());
        places.push_back(number - views_.size());
      }
      images.push_back(
          ToImage8(number < views_.size() ? views_[number].rgb : queries[number - views_.size()].proposal.rgb));
    }
    if (asked.empty()) continue;
    const std::vector<Buffer<float>> answers = network_->Confidence(images, asked);
    for (size_t i = 0; i < answers.size(); ++i) maps[places[i]] = MapOf(answers[i]);
    if (options_.on_pass) options_.on_pass(asked.size());
  }
  return maps;
}

}  // namespace oraclegs
