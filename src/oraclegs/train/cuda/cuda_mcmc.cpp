#include "oraclegs/train/cuda/cuda_mcmc.h"

#include <algorithm>
#include <vector>

#include "oraclegs/core/cuda/device_array.h"
#include "oraclegs/train/cuda/refine.h"
#include "oraclegs/train/cuda/step.h"
#include "oraclegs/train/mcmc.h"
#include "oraclegs/train/noise.h"
#include "oraclegs/train/train_device.h"

namespace oraclegs::cuda {
namespace {

class CudaMcmcDensifier final : public Densifier {
 public:
  CudaMcmcDensifier(const DensifierSetup& setup, const DeviceViews& views, int64_t capacity) : options_(setup.options) {
    std::vector<double> choose;
    for (const auto& row : Binomials()) choose.insert(choose.end(), row.begin(), row.end());
    choose_.Upload(choose.data(), static_cast<int64_t>(choose.size()));
    if (options_.prune_floaters) {
      const std::vector<DepthView> with_depth = views.DepthViews(setup.plan.photos());
      num_depth_views_ = static_cast<int>(with_depth.size());
      depth_views_.Upload(with_depth.data(), num_depth_views_);
      floater_counts_.ReserveExactly(2);
    }
    Reserve(capacity);
  }

  bool AddsNoise() const override { return true; }

  void Refine(const Iteration& iteration, TrainedModel* model) override {
    const int64_t n = model->gaussians.size();
    if (options_.prune_floaters) {
      RunPruneFloaters(
          {model->gaussians.Rows(), n, depth_views_.data(), num_depth_views_, floats_.data(), floater_counts_.data()},
          kStream);
    }
    const RefineInput in = Refinement(iteration, *model);
    RunRelocate(in, kStream);
    if (const int64_t added = GrowthOf(n, options_.max_gaussians); added > 0) {
      RunWeigh(in, kStream);
      total_weight_.Ask(in.scratch.weights + n - 1, kStream);
      if (total_weight_.Get() > 0) {
        const auto grow = [&](auto& buffer) { buffer = buffer.GrownTo(n + added); };
        model->gaussians.ForEach([&](const char*, Buffer<float>& buffer) { grow(buffer); });
        model->adam.ForEachMoment([&](const char*, const char*, auto& buffer) { grow(buffer); });
        RefineInput grown = Refinement(iteration, *model);  // the buffers may have moved
        grown.count = n;
        RunGrow(grown, added, kStream);
      }
    }
    const MeansNoise noise{iteration.seed, iteration.number, iteration.rates.means};
    RunNoise({model->gaussians.size(), model->gaussians.Rows(), noise.Constants()}, kStream);
  }

  /// Makes room where a checkpoint has more Gaussians than the run was to have.
  void Begin(int64_t gaussians) override {
    if (gaussians > capacity_) Reserve(gaussians);
  }
  void Restore(const NamedState&, int64_t gaussians) override { Begin(gaussians); }

 private:
  void Reserve(int64_t capacity) {
    capacity_ = capacity;
    if (options_.prune_floaters) floats_.ReserveExactly(capacity_);
    weights_.ReserveExactly(capacity_);
    ranks_.ReserveExactly(capacity_);
    totals_.ReserveExactly(RefineBlocks(capacity_));
    sources_.ReserveExactly(capacity_);
    draws_.ReserveExactly(capacity_);
  }

  RefineInput Refinement(const Iteration& iteration, const TrainedModel& model) {
    RefineInput in;
    in.seed = iteration.seed;
    in.iteration = iteration.number;
    in.count = model.gaussians.size();
    in.params = model.gaussians.Rows();
    in.moments = model.adam.Rows();
    in.scratch = {weights_.data(), ranks_.data(), totals_.data(), sources_.data(), draws_.data(), choose_.data()};
    return in;
  }

  const TrainOptions& options_;
  int64_t capacity_ = 0;  // Gaussians
  Readback<uint64_t> total_weight_;
  DeviceArray<uint64_t> weights_{"relocation"}, ranks_{"relocation"}, totals_{"relocation"};
  DeviceArray<int> sources_{"relocation"}, draws_{"relocation"};
  DeviceArray<double> choose_{"relocation"};
  DeviceArray<DepthView> depth_views_{"the pruning of floaters"};
  int num_depth_views_ = 0;
  DeviceArray<uint8_t> floats_{"the pruning of floaters"};
  DeviceArray<int> floater_counts_{"the pruning of floaters"};
};

}  // namespace

std::unique_ptr<Densifier> MakeCudaMcmcDensifier(const DensifierSetup& setup, const DeviceViews& views,
                                                 int64_t capacity) {
  return std::make_unique<CudaMcmcDensifier>(setup, views, capacity);
}

}  // namespace oraclegs::cuda
