#include "oraclegs/validate/feature_source.h"

#include <algorithm>

#include "oraclegs/core/interrupt.h"
#include "oraclegs/core/parallel.h"

namespace oraclegs {
namespace {

bool IsOfOneView(const Query& a, const Query& b) {
  const Camera &x = a.proposal.camera, &y = b.proposal.camera;
  return a.held_out == b.held_out && x.width == y.width && x.height == y.height && x.fx == y.fx && x.fy == y.fy &&
         x.cx == y.cx && x.cy == y.cy && x.cam_from_world.matrix() == y.cam_from_world.matrix();
}

/// Indices of queries by view: candidates of one target share its warp.
std::vector<std::vector<size_t>> GroupByView(const std::vector<Query>& queries) {
  std::vector<std::vector<size_t>> groups;
  for (size_t q = 0; q < queries.size(); ++q) {
    const auto same = std::find_if(groups.begin(), groups.end(), [&](const std::vector<size_t>& group) {
      return IsOfOneView(queries[group.front()], queries[q]);
    });
    if (same == groups.end()) {
      groups.push_back({q});
    } else {
      same->push_back(q);
    }
  }
  return groups;
}

}  // namespace

const float* PixelRows::Row(size_t pixel, Space* space) const {
  if (features_.empty()) return &second_[pixel];
  if (second_.empty() && comparisons_.empty()) return features_[pixel].data();
  auto end = std::copy(features_[pixel].begin(), features_[pixel].end(), space->begin());
  for (const std::vector<Comparison>& compared : comparisons_) {
    end = std::copy(compared[pixel].begin(), compared[pixel].end(), end);
  }
  if (!second_.empty()) *end = second_[pixel];
  return space->data();
}

FeatureSource FeatureSource::Thorough() const {
  FeatureSource thorough = *this;
  thorough.scrutiny_ = Scrutiny::kThorough;
  return thorough;
}

std::string FeatureSource::name() const {
  if (!second_) return "consistency";
  return ReadsImages() ? second_->name() + "+consistency" : second_->name();
}

std::vector<ConfidenceMap> FeatureSource::SecondMaps(const std::vector<Query>& queries) const {
  return second_ ? second_->Predict(queries) : std::vector<ConfidenceMap>(queries.size());
}

void FeatureSource::ForEach(const std::vector<Query>& queries, const std::vector<ConfidenceMap>& second,
                            FunctionRef<void(size_t, const PixelRows&)> use) const {
  const std::vector<std::vector<size_t>> groups = GroupByView(queries);
  ParallelFor(static_cast<int64_t>(groups.size()), [&](int64_t g) {
    ThrowIfInterrupted();
    const std::vector<size_t>& group = groups[static_cast<size_t>(g)];
    const Query& first = queries[group.front()];
    const WarpedView warped = ReadsImages() ? warper_.Warp(first.proposal.camera, first.held_out) : WarpedView();
    for (const size_t q : group) {
      const Query& query = queries[q];
      std::vector<Features> features;
      std::vector<std::vector<Comparison>> comparisons;
      if (ReadsImages()) features = FeaturesOf(query.proposal, warped);
      if (ReadsImages() && scrutiny_ == Scrutiny::kThorough) {
        comparisons.push_back(Compare(query.proposal.rgb, warped.rgb));
        if (!query.proxy_render.data.empty()) comparisons.push_back(Compare(query.proposal.rgb, query.proxy_render));
      }
      use(q, PixelRows(std::move(features), std::move(comparisons), second[q]));
    }
  });
}

}  // namespace oraclegs
