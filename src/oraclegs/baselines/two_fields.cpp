#include "oraclegs/baselines/two_fields.h"

#include <algorithm>
#include <utility>

#include "oraclegs/baselines/pseudo_views.h"
#include "oraclegs/baselines/random_background.h"
#include "oraclegs/core/parallel.h"
#include "oraclegs/gaussians/neighbors.h"
#include "oraclegs/loss/photometric.h"
#include "oraclegs/render/image_buffer.h"
#include "oraclegs/render/render.h"
#include "oraclegs/train/train_device.h"

namespace oraclegs {
namespace {

constexpr uint64_t kSecondSeed = 0x9E3779B97F4A7C15;  // added to the first one's
constexpr const char* kSecondModel = "second";        // in the checkpoint

std::vector<int64_t> RowsOf(const std::vector<uint8_t>& keep) {
  std::vector<int64_t> rows;
  for (size_t i = 0; i < keep.size(); ++i) {
    if (keep[i] != 0) rows.push_back(static_cast<int64_t>(i));
  }
  return rows;
}

}  // namespace

std::vector<uint8_t> CoPruneKeep(const Gaussians& model, const Gaussians& other, double max_distance) {
  model.Check("CoPruneKeep");
  other.Check("CoPruneKeep");
  constexpr int64_t kGrain = 1024;  // Gaussians a task
  const auto center = [](const Gaussians& g, int64_t i) -> Eigen::Vector3f {
    return Eigen::Vector3f::Map(g.means.data() + 3 * i);
  };
  std::vector<Eigen::Vector3f> others(static_cast<size_t>(other.size()));
  for (int64_t i = 0; i < other.size(); ++i) others[i] = center(other, i);
  const KdTree tree(others);
  std::vector<uint8_t> keep(static_cast<size_t>(model.size()));
  ParallelBlocks(model.size(), kGrain, [&](int64_t begin, int64_t end) {
    for (int64_t i = begin; i < end; ++i) keep[i] = tree.HasWithin(center(model, i), max_distance);
  });
  return keep;
}

struct TwoFields::State {
  /// A model and its render from a pseudo view.
  struct Field {
    std::unique_ptr<Rasterizer> rasterizer = MakeRasterizer(kCpu);
    PhotometricLoss photometric;
    ImageBuffer gradient;
    Gaussians grads;

    /// Returns the loss between the image, the last render of `gaussians`, and the target, each on the host; writes
    /// its gradient to `grads`.
    double Pull(const Gaussians& gaussians, const Buffer<float>& image, const Buffer<float>& target,
                const PhotometricWeights& weights) {
      const Device device = gaussians.device();
      Buffer<float> of_image = gradient.Get(image.shape());
      const double loss = photometric(image, target, {}, weights, &of_image).loss;
      if (grads.size() != gaussians.size()) grads = Gaussians::Zeros(gaussians.size(), device);
      rasterizer->Backward(gaussians, {of_image.To(device), {}, {}}, &grads);
      return loss;
    }
  };

  /// Part of the second model's trainer: adds the gradients that TwoFields found for it.
  class SecondPart final : public MethodPart {
   public:
    double BeforeView(const Iteration&, TrainedModel*, PartGradients* grads) override {
      if (pending != nullptr) grads->push_back(std::exchange(pending, nullptr));
      return 0;
    }

    const Gaussians* pending = nullptr;  // gradients that its next step takes as well
  };

  explicit State(const BaselineSetup& setup)
      : options(setup.options),
        seed(setup.seed),
        view_seed(setup.view_seed.value_or(seed)),
        background(setup.background),
        settings(setup.baseline),
        random_background(settings.random_background &&
                          std::none_of(setup.data.photos.begin(), setup.data.photos.end(),
                                       [](const TrainView& photo) { return photo.alpha.defined(); })),
        views(PseudoViewsBetween(Cameras(setup.data.photos), kPseudoViews, setup.seed)),
        second_part(std::make_shared<SecondPart>()) {
    TrainSetup other = setup;
    other.seed = setup.seed + kSecondSeed;
    other.view_seed = view_seed;
    other.start = setup.start.Clone();
    other.parts = {second_part};
    if (settings.random_background) other.parts.push_back(std::make_shared<RandomBackgrounds>(view_seed));
    second = std::make_unique<Trainer>(std::move(other), setup.make_device);
  }

  double Agree(const Iteration& iteration, const TrainedModel& model, PartGradients* grads);

  TrainOptions options;
  uint64_t seed, view_seed;
  std::array<float, 3> background;
  BaselineSettings settings;
  bool random_background;
  std::vector<Camera> views;
  std::shared_ptr<SecondPart> second_part;
  std::unique_ptr<Trainer> second;
  Field one, two;
};

/// Adds to each model the gradient of the difference between both renders of a pseudo view, with the other render held
/// constant.
double TwoFields::State::Agree(const Iteration& iteration, const TrainedModel& model, PartGradients* grads) {
  const Camera& camera = DrawPseudoView(views, seed, iteration.number);
  const RenderOptions render{random_background ? RandomBackground(view_seed, iteration.number) : background,
                             iteration.sh_degree, options.antialiased};
  const Gaussians& other = second->gaussians();
  const Buffer<float> a = one.rasterizer->Forward(model.gaussians, camera, render, RenderPass::kTrain).image.To(kCpu);
  const Buffer<float> b = two.rasterizer->Forward(other, camera, render, RenderPass::kTrain).image.To(kCpu);
  const PhotometricWeights weights{static_cast<float>(1 - options.ssim_weight),
                                   static_cast<float>(options.ssim_weight)};
  const double loss = one.Pull(model.gaussians, a, b, weights);
  two.Pull(other, b, a, weights);
  grads->push_back(&one.grads);
  second_part->pending = &two.grads;
  return loss;
}

TwoFields::TwoFields(const BaselineSetup& first) : state_(std::make_unique<State>(first)) {}

TwoFields::~TwoFields() = default;

void TwoFields::Attach(const TrainDevice& device) {
  state_->one.rasterizer = device.NewRasterizer();
  state_->two.rasterizer = device.NewRasterizer();
}

/// Co-prunes both models after every kCoPruneInterval-th iteration once densification has begun. The masks of both are
/// found before either loses Gaussians. A model that would lose all its Gaussians keeps them.
void TwoFields::Remove(const Iteration& iteration, TrainedModel* model) {
  State& s = *state_;
  const int64_t done = iteration.number - 1;
  if (done <= s.options.refine_start || done % kCoPruneInterval != 0) return;
  const double distance = s.settings.co_prune_distance;
  const Gaussians mine = model->gaussians.To(kCpu), its = second().To(kCpu);
  const std::vector<int64_t> first = RowsOf(CoPruneKeep(mine, its, distance));
  const std::vector<int64_t> other = RowsOf(CoPruneKeep(its, mine, distance));
  if (!first.empty()) KeepRows(first, &model->gaussians, &model->adam);
  if (!other.empty()) s.second->Keep(other);
}

double TwoFields::BeforeView(const Iteration& iteration, TrainedModel* model, PartGradients* grads) {
  State& s = *state_;
  double loss = 0;
  if (iteration.number >= s.settings.co_start && iteration.moves) loss = s.Agree(iteration, *model, grads);
  s.second->Step();
  return loss;
}

void TwoFields::Save(NamedState* state) const {
  state->models[kSecondModel] = std::make_shared<const Checkpoint>(state_->second->MakeCheckpoint());
}

void TwoFields::Restore(const NamedState& state) { state_->second->Restore(state.Model(kSecondModel)); }

const Gaussians& TwoFields::second() const { return state_->second->gaussians(); }

}  // namespace oraclegs
