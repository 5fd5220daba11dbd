#include "oraclegs/train/methods/two_fields.h"

#include <algorithm>
#include <utility>

#include "oraclegs/loss/photometric.h"
#include "oraclegs/render/image_buffer.h"
#include "oraclegs/render/make_rasterizer.h"
#include "oraclegs/train/adaptive_density.h"
#include "oraclegs/train/baselines/co_prune.h"
#include "oraclegs/train/baselines/pseudo_views.h"
#include "oraclegs/train/baselines/random_background.h"
#include "oraclegs/train/make_train_device.h"

namespace oraclegs {
namespace {

constexpr uint64_t kSecondSeed = 0x9E3779B97F4A7C15;  // added to the first one's

std::vector<int64_t> RowsOf(const std::vector<uint8_t>& keep) {
  std::vector<int64_t> rows;
  for (size_t i = 0; i < keep.size(); ++i) {
    if (keep[i] != 0) rows.push_back(static_cast<int64_t>(i));
  }
  return rows;
}

}  // namespace

struct TwoFields::State {
  /// A model and its render from a pseudo view.
  struct Field {
    std::unique_ptr<Rasterizer> rasterizer = MakeRasterizer(kCpu);
    PhotometricLoss photometric;
    ImageBuffer gradient;
    Gaussians grads;

    /// Returns the loss between `out`, the last render of `gaussians`, and the target; writes its gradient to `grads`.
    double Pull(const Gaussians& gaussians, const RenderOutput& out, const Buffer<float>& target,
                const PhotometricWeights& weights) {
      RenderGrads upstream{gradient.Get(out.image.shape()), {}, {}};
      const double loss = photometric(out.image, target, {}, weights, &upstream.image).loss;
      if (grads.size() != gaussians.size()) grads = Gaussians::Zeros(gaussians.size());
      rasterizer->Backward(gaussians, upstream, &grads);
      return loss;
    }
  };

  /// Part of the second model's trainer: adds the gradients that TwoFields found for it.
  class SecondPart final : public MethodPart {
   public:
    double BeforeView(const Iteration&, TrainedModel*, Gaussians* grads) override {
      if (pending != nullptr) AddGaussians(*std::exchange(pending, nullptr), grads);
      return 0;
    }

    const Gaussians* pending = nullptr;  // gradients that its next step takes as well
  };

  explicit State(const TrainSetup& setup)
      : options(setup.options.Settled()),
        seed(setup.seed),
        view_seed(setup.view_seed.value_or(seed)),
        background(setup.background),
        random_background(options.baseline.random_background &&
                          std::none_of(setup.data.photos.begin(), setup.data.photos.end(),
                                       [](const TrainView& photo) { return photo.alpha.defined(); })),
        views(PseudoViewsBetween(Cameras(setup.data.photos), kPseudoViews, setup.seed)),
        second_part(std::make_shared<SecondPart>()) {
    TrainSetup other = setup;
    other.seed = setup.seed + kSecondSeed;
    other.view_seed = view_seed;
    other.start = setup.start.Clone();
    other.parts = {second_part};
    second =
        std::make_unique<Trainer>(std::move(other), [](const TrainDeviceSetup& s) { return MakeTrainDevice(kCpu, s); });
  }

  double Agree(const Iteration& iteration, const TrainedModel& model, Gaussians* grads);

  TrainOptions options;
  uint64_t seed, view_seed;
  std::array<float, 3> background;
  bool random_background;
  std::vector<Camera> views;
  std::shared_ptr<SecondPart> second_part;
  std::unique_ptr<Trainer> second;
  Field one, two;
};

/// Adds to each model the gradient of the difference between both renders of a pseudo view, with the other render held
/// constant.
double TwoFields::State::Agree(const Iteration& iteration, const TrainedModel& model, Gaussians* grads) {
  const Camera& camera = DrawPseudoView(views, seed, iteration.number);
  const RenderOptions render{random_background ? RandomBackground(view_seed, iteration.number) : background,
                             iteration.sh_degree, options.antialiased};
  const Gaussians& other = second->gaussians();
  const RenderOutput a = one.rasterizer->Forward(model.gaussians, camera, render, RenderPass::kTrain);
  const RenderOutput b = two.rasterizer->Forward(other, camera, render, RenderPass::kTrain);
  const PhotometricWeights weights{static_cast<float>(1 - options.ssim_weight),
                                   static_cast<float>(options.ssim_weight)};
  const double loss = one.Pull(model.gaussians, a, b.image, weights);
  two.Pull(other, b, a.image, weights);
  AddGaussians(one.grads, grads);
  second_part->pending = &two.grads;
  return loss;
}

TwoFields::TwoFields(const TrainSetup& first) : state_(std::make_unique<State>(first)) {}

TwoFields::~TwoFields() = default;

/// Co-prunes both models after every kCoPruneInterval-th iteration once densification has begun. The masks of both are
/// found before either loses Gaussians. A model that would lose all its Gaussians keeps them.
void TwoFields::Remove(const Iteration& iteration, TrainedModel* model) {
  State& s = *state_;
  const int64_t done = iteration.number - 1;
  if (done <= s.options.refine_start.value() || done % kCoPruneInterval != 0) return;
  const double distance = s.options.baseline.co_prune_distance;
  const std::vector<int64_t> first = RowsOf(CoPruneKeep(model->gaussians, second(), distance));
  const std::vector<int64_t> other = RowsOf(CoPruneKeep(second(), model->gaussians, distance));
  if (!first.empty()) KeepRows(first, &model->gaussians, &model->adam);
  if (!other.empty()) s.second->Keep(other);
}

double TwoFields::BeforeView(const Iteration& iteration, TrainedModel* model, Gaussians* grads) {
  State& s = *state_;
  double loss = 0;
  if (iteration.number >= s.options.baseline.co_start && iteration.moves) loss = s.Agree(iteration, *model, grads);
  s.second->Step();
  return loss;
}

std::shared_ptr<const Checkpoint> TwoFields::Save() const {
  return std::make_shared<const Checkpoint>(state_->second->MakeCheckpoint());
}

void TwoFields::Restore(const Checkpoint* second) {
  if (second == nullptr)
    throw InputError("the checkpoint holds one model, --two-fields goes on from two; start anew with --overwrite");
  state_->second->Restore(*second);
}

const Gaussians& TwoFields::second() const { return state_->second->gaussians(); }

}  // namespace oraclegs
