#include "bench/inputs.h"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <utility>

#include "oraclegs/render/render.h"
#include "oraclegs/run/start.h"
#include "oraclegs/stages/evaluate_stage.h"
#include "oraclegs/train/mcmc.h"
#include "render/scenes.h"

namespace oraclegs {
namespace {

constexpr uint64_t kSeed = 1;
constexpr int kNever = 10'000'000;  // iterations; the largest that the options take
constexpr int kSyntheticViews = 3;

/// Reads options from the JSON of a saved run; options that it lacks keep their defaults.
struct SavedOptionReader {
  const nlohmann::json& saved;

  template <class T, class... Rest>
  void operator()(const char* name, T& value, Rest&&...) const {
    if (!saved.contains(name)) return;
    const nlohmann::json& entry = saved.at(name);
    SetOption(name, entry.is_string() ? entry.get<std::string>() : entry.dump(), &value);
  }
};

/// Random choice of n Gaussians without replacement, in their order.
Gaussians Thinned(const Gaussians& gaussians, int64_t n) {
  std::vector<int64_t> rows(gaussians.size());
  std::iota(rows.begin(), rows.end(), 0);
  Rng rng(kSeed, RandomStream::kInitialPoints);
  for (int64_t i = 0; i < n; ++i) std::swap(rows[i], rows[i + rng.Index(gaussians.size() - i)]);
  rows.resize(n);
  std::sort(rows.begin(), rows.end());
  Gaussians thinned = Gaussians::Empty(n);
  std::vector<Buffer<float>> from;
  gaussians.ForEach([&](const char*, const Buffer<float>& all) { from.push_back(all); });
  size_t parameter = 0;
  thinned.ForEach([&](const char*, const Buffer<float>& to) {
    const Buffer<float>& all = from[parameter++];
    for (int64_t i = 0; i < n; ++i)
      std::copy_n(all.Rows(rows[i], rows[i] + 1).data(), to.shape().row(), to.data() + i * to.shape().row());
  });
  return thinned;
}

Gaussians Grown(const Gaussians& gaussians, int64_t n) {
  Gaussians grown = gaussians.Clone();
  Adam adam(grown.size());
  for (int64_t iteration = 1; grown.size() < n; ++iteration) {
    if (AddGaussians(kSeed, iteration, n, &grown, &adam) == 0) throw UsageError("too few Gaussians to grow from");
  }
  return grown.Clone();  // without the spare rows
}

TrainView ResizedView(const LoadedView& view, const InputSize& size) {
  const double pixels = static_cast<double>(size.width) * size.height;
  const double aspect = static_cast<double>(view.rgb.width) / view.rgb.height;
  int width = size.width, height = size.height;
  if (view.rgb.width * size.height != view.rgb.height * size.width) {
    width = static_cast<int>(std::lround(std::sqrt(pixels * aspect)));
    height = static_cast<int>(std::lround(pixels / width));
  }
  LoadedView resized = view;
  resized.mask.clear();
  resized.rgb = ResizeArea(view.rgb, width, height);
  resized.camera = Resized(view.camera, width, height);
  return ToTrainView(resized);
}

BenchInput FromWorkspace(const std::filesystem::path& workspace, const InputSize& size) {
  const SavedRun saved = ReadSavedRun(workspace);
  RunOptions options;
  RunOptions::ForEachShapingGroup(options, [&](const char*, auto& group) {
    std::remove_cvref_t<decltype(group)>::Visit(group, SavedOptionReader{saved.options});
  });
  const PosedScene posed = ReadPosedScene(saved.scene, options, Silent());

  BenchInput input;
  input.background = BackgroundColor(options.image.Settled().background);
  input.antialiased = options.train.antialiased;
  for (const LoadedView& view : LoadViews(posed.scene, posed.split.train, options.image.Settled(), Silent())) {
    input.views.push_back(ResizedView(view, size));
  }
  input.gaussians = LoadModel(WorkspacePaths(workspace).point_cloud(), options, kCpu, posed.frame).gaussians;
  const int64_t n = input.gaussians.size();
  if (n > size.gaussians) input.gaussians = Thinned(input.gaussians, size.gaussians);
  if (n < size.gaussians) input.gaussians = Grown(input.gaussians, size.gaussians);
  return input;
}

BenchInput Synthetic(const InputSize& size) {
  // Scales shrink with the count, as training makes them.
  const double scale = 2.2 / std::sqrt(static_cast<double>(size.gaussians));
  const Camera front = FrontCamera(size.width, size.height);
  BenchInput input;
  const Buffer<float> image =
      MakeRasterizer(kCpu)
          ->Forward(RandomGaussians(size.gaussians, scale, kSeed + 1), front, {}, RenderPass::kInference)
          .image.Clone();
  for (int i = 0; i < kSyntheticViews; ++i) {
    Camera camera = front;
    camera.cam_from_world.translation().x() = 0.1 * i;
    input.views.push_back({"view", camera, image, {}});
  }
  input.gaussians = RandomGaussians(size.gaussians, scale, kSeed);
  return input;
}

TrainOptions OptionsOf(const BenchInput& input) {
  TrainOptions options;
  options.iterations = kNever;
  options.antialiased = input.antialiased;
  options.sh_degree_interval = 1;
  return options;
}

}  // namespace

BenchInput MakeInput(const InputSource& source, const InputSize& size) {
  return source.workspace.empty() ? Synthetic(size) : FromWorkspace(source.workspace, size);
}

Adam SteadyAdam(int64_t n) {
  Adam adam(n);
  adam.v.ForEach([](const char*, Buffer<float>& t) { std::fill_n(t.data(), t.count(), 1.f); });
  adam.step = 100'000;  // no bias is left to correct
  return adam;
}

std::unique_ptr<Trainer> MakeSteadyTrainer(const BenchInput& input) {
  TrainOptions options = OptionsOf(input);
  options.max_gaussians = static_cast<int>(input.gaussians.size());
  options.refine_start = kNever;
  options.sh_moments = ShMoments::kFull;  // whose bytes the table counts, and of which SteadyAdam is
  auto trainer = std::make_unique<Trainer>(options, 0, input.background, input.views, input.gaussians);
  Checkpoint checkpoint = trainer->MakeCheckpoint();
  checkpoint.iteration = kNever - 100'000;  // where rates are at their end, so that the steps leave the state as it is
  checkpoint.adam = SteadyAdam(input.gaussians.size());
  trainer->Restore(checkpoint);
  return trainer;
}

std::unique_ptr<Trainer> MakeGrowingTrainer(BenchInput&& input, int64_t max_gaussians) {
  TrainOptions options = OptionsOf(input);
  options.max_gaussians = static_cast<int>(max_gaussians);
  options.refine_start = 0;
  options.refine_every = 2;
  options.refine_stop = 1;
  return std::make_unique<Trainer>(options, 0, input.background, std::move(input.views), std::move(input.gaussians));
}

}  // namespace oraclegs
