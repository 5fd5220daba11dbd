#include "oraclegs/train/cuda/cuda_view_loss.h"

#include <algorithm>

#include "oraclegs/loss/cuda/masked_l1.h"
#include "oraclegs/render/cuda/torch_memory.h"
#include "oraclegs/train/packed_picture.h"
#include "oraclegs/train/schedule.h"

namespace oraclegs::cuda {
namespace {

constexpr cudaStream_t kStream = nullptr;  // libtorch's too

constexpr ViewKind kKinds[] = {ViewKind::kPhotograph, ViewKind::kProposal};

DeviceViewPictures Pack(const TrainView& view) {
  DeviceViewPictures pictures;
  pictures.image = Packed(view.image);
  pictures.confidence = Packed(view.confidence);
  pictures.inv_depth = view.inv_depth;
  pictures.depth_mask = Packed(view.depth_mask);
  pictures.alpha = view.alpha;
  pictures.mean_confidence = MeanConfidence(view.confidence);
  return pictures;
}

DeviceImage ImageOf(const Buffer<float>& picture) {
  if (!picture.defined()) return {};
  return {picture.data_ptr(), picture.scalar_type() == torch::kByte};
}

Buffer<float> View(const Buffer<float>& buffer, std::initializer_list<int64_t> shape) {
  int64_t count = 1;
  for (const int64_t size : shape) count *= size;
  return buffer.narrow(0, 0, count).view(shape);
}

void UploadMaps(const std::vector<ExposureMap>& maps, DeviceArray<float>* to) {
  to->Upload(maps.data()->data(), kExposureNumbers * static_cast<int64_t>(maps.size()));
}

std::vector<ExposureMap> DownloadMaps(const DeviceArray<float>& from, int views) {
  std::vector<ExposureMap> maps(static_cast<size_t>(views));
  if (views > 0) from.Download(kExposureNumbers * static_cast<int64_t>(views), maps.data()->data());
  return maps;
}

/// Queues weight * mean(|rendered - target| * mask) of the pictures that `in` names; its gradient goes to `grad`.
void AddMaskedL1(MaskedL1Input in, double weight, const Buffer<float>& grad, LossTerms* terms) {
  in.pixels = grad.count();
  const double scale = weight / static_cast<double>(in.pixels);
  in.scale = static_cast<float>(scale);
  in.grad = grad.data();
  RunMaskedL1(in, kStream);
  terms->Add({in.sums, MaskedL1Blocks(in.pixels), 1, scale});
}

}  // namespace

int64_t DeviceViewPictures::bytes() const {
  int64_t sum = 0;
  for (const Buffer<float>& t : {image, confidence, inv_depth, depth_mask, alpha, lpips_target}) {
    if (t.defined()) sum += t.count() * static_cast<int64_t>(t.element_size());
  }
  return sum;
}

DeviceViews::DeviceViews(const ViewLoss& view_loss) {
  for (const ViewKind kind : kKinds) {
    for (const bool coarse : {false, true}) {
      for (const TrainView& view : view_loss.Views(kind, coarse)) {
        DeviceViewPictures pictures = Pack(view);
        if (kind == ViewKind::kProposal && view_loss.has_lpips()) pictures.lpips_target = view.image;
        groups_[static_cast<int>(kind)][coarse].push_back(std::move(pictures));
      }
    }
  }
}

void DeviceViews::MoveTo(Device device) {
  for (auto& kind : groups_) {
    for (auto& group : kind) {
      for (DeviceViewPictures& view : group) {
        for (Buffer<float>* t : view.Tensors()) {
          if (t->defined()) *t = t->to(device);
        }
      }
    }
  }
}

const DeviceViewPictures& DeviceViews::At(const SampledView& view, bool coarse) const {
  return groups_[static_cast<int>(view.kind)][coarse][static_cast<size_t>(view.index)];
}

std::vector<DepthView> DeviceViews::DepthViews(const std::vector<TrainView>& photographs) const {
  std::vector<DepthView> views;
  for (size_t i = 0; i < photographs.size(); ++i) {
    const DeviceViewPictures& pictures = groups_[static_cast<int>(ViewKind::kPhotograph)][false][i];
    if (!pictures.inv_depth.defined()) continue;
    const Camera& camera = photographs[i].camera;
    DepthView view{};
    const Eigen::Matrix4d pose = camera.cam_from_world.matrix();
    for (int row = 0; row < 3; ++row) {
      for (int column = 0; column < 4; ++column) view.cam_from_world[4 * row + column] = pose(row, column);
    }
    view.fx = camera.fx, view.fy = camera.fy, view.cx = camera.cx, view.cy = camera.cy;
    view.width = camera.width, view.height = camera.height;
    view.inv_depth = pictures.inv_depth.data();
    view.depth_mask = ImageOf(pictures.depth_mask);
    views.push_back(view);
  }
  return views;
}

int64_t DeviceViews::bytes() const {
  int64_t sum = 0;
  for (const auto& kind : groups_) {
    for (const auto& group : kind) {
      for (const DeviceViewPictures& view : group) sum += view.bytes();
    }
  }
  return sum;
}

LargestView LargestOf(const ViewLoss& view_loss) {
  LargestView largest;
  for (const ViewKind kind : kKinds) {
    for (const TrainView& view : view_loss.Views(kind, false)) {
      largest.pixels = std::max(largest.pixels, int64_t{view.camera.width} * view.camera.height);
      largest.tiles = std::max(largest.tiles, PhotometricTiles(view.camera.width, view.camera.height));
    }
  }
  return largest;
}

CudaViewLoss::CudaViewLoss(const ViewLoss& view_loss, DeviceViews views, Device device)
    : view_loss_(view_loss), views_(std::move(views)), iterations_(view_loss.options().iterations) {
  const auto floats = torch::TensorOptions().dtype(torch::kFloat).device(device);
  const auto [pixels, tiles] = LargestOf(view_loss);
  const auto image = [pixels = pixels, floats](int64_t channels) {
    return WithMemory("the gradients of the picture", [&] { return torch::empty({channels * pixels}, floats); });
  };
  grad_image_ = image(3);
  grad_inv_depth_ = image(1);
  grad_alpha_ = image(1);
  slopes_.ReserveExactly(9 * pixels);
  photometric_sums_.ReserveExactly(tiles);
  depth_sums_.ReserveExactly(MaskedL1Blocks(pixels));
  alpha_sums_.ReserveExactly(MaskedL1Blocks(pixels));
  if (view_loss.exposures() == nullptr) return;
  shown_ = image(3);
  exposure_sums_.ReserveExactly(kExposureNumbers * ExposureBlocks(pixels));
  pull_.ReserveExactly(1);
  const ExposureState& start = view_loss.exposures()->state();
  rows_.views = static_cast<int>(start.maps.size());
  RestoreExposures(start);
}

RenderGrads CudaViewLoss::operator()(const Iteration& iteration, const RenderOutput& out, LossTerms* terms) {
  const int64_t height = out.image.size(0), width = out.image.size(1);
  Buffer<float> image = out.image;
  if (HasExposure(iteration)) {
    image = View(shown_, {height, width, 3});
    ExposurePixels in;
    in.pixels = height * width;
    in.map = rows_.maps + kExposureNumbers * iteration.view.index;
    in.image = out.image.data();
    in.shown = image.data();
    RunExposureApply(in, kStream);
  }
  AddPhotometric(iteration, image, terms);
  if (HasExposure(iteration)) StepExposure(iteration, out.image, terms);
  AddLpips(iteration, out.image, terms);
  RenderGrads grads;
  grads.image = View(grad_image_, {height, width, 3});
  grads.inv_depth = AddDepth(iteration, out.inv_depth, terms);
  grads.alpha = AddAlpha(iteration, out.alpha, terms);
  return grads;
}

void CudaViewLoss::AddPhotometric(const Iteration& iteration, const Buffer<float>& image, LossTerms* terms) {
  const DeviceViewPictures& pictures = Pictures(iteration);
  const bool is_proposal = iteration.view.kind == ViewKind::kProposal;
  const Objective& objective = view_loss_.objective();
  const PhotometricWeights weights = is_proposal ? objective.ProposalWeights() : objective.PhotographWeights();
  PhotometricInput in;
  in.height = static_cast<int>(image.size(0));
  in.width = static_cast<int>(image.size(1));
  in.render = image.data();
  in.target = ImageOf(pictures.image);
  in.confidence = ImageOf(pictures.confidence);
  in.meaning = is_proposal ? MaskMeaning::kConfidence : MaskMeaning::kMask;
  const double entries = 3.0 * in.width * in.height;
  in.l1_scale = static_cast<float>(weights.l1 / entries);
  in.dssim_scale = static_cast<float>(weights.dssim / entries);
  const int64_t tiles = PhotometricTiles(in.width, in.height);
  RunPhotometric(in, {photometric_sums_.data(), slopes_.data(), grad_image_.data()}, kStream);
  const PhotometricSums* sums = photometric_sums_.data();
  terms->Add({&sums->l1, tiles, 2, static_cast<double>(weights.l1) / entries});
  terms->Add({&sums->dssim, tiles, 2, static_cast<double>(weights.dssim) / entries});
}

void CudaViewLoss::StepExposure(const Iteration& iteration, const Buffer<float>& image, LossTerms* terms) {
  ExposurePixels pixels;
  pixels.pixels = image.size(0) * image.size(1);
  pixels.map = rows_.maps + kExposureNumbers * iteration.view.index;
  pixels.image = image.data();
  pixels.grad = grad_image_.data();
  pixels.sums = exposure_sums_.data();
  RunExposureBackward(pixels, kStream);
  ExposureStepInput step;
  step.rows = rows_;
  step.view = iteration.view.index;
  step.sums = exposure_sums_.data();
  step.blocks = ExposureBlocks(pixels.pixels);
  step.learning_rate = ExposureLearningRate(iteration.number, iterations_);
  step.moves = iteration.moves;
  step.pull = pull_.data();
  RunExposureStep(step, kStream);
  terms->Add({pull_.data(), 1, 1, 1});
}

void CudaViewLoss::AddLpips(const Iteration& iteration, const Buffer<float>& image, LossTerms* terms) {
  if (iteration.view.kind != ViewKind::kProposal) return;
  const DeviceViewPictures& pictures = Pictures(iteration);
  const double weight = view_loss_.objective().LpipsWeight(pictures.mean_confidence);
  if (weight == 0) return;  // the network is what takes the time
  Buffer<float> grad = View(grad_image_, {image.size(0), image.size(1), 3});
  const auto distance = [&] { return view_loss_.objective().lpips()(image, pictures.lpips_target, weight, &grad); };
  terms->constant +=
      weight * WithMemory("LPIPS of a proposal", distance, "give --proposal-lpips 0 or raise --downscale");
}

/// Undefined, which the rasteriser takes for zero at no cost, where there is no depth to learn from.
Buffer<float> CudaViewLoss::AddDepth(const Iteration& iteration, const Buffer<float>& inv_depth, LossTerms* terms) {
  const DeviceViewPictures& pictures = Pictures(iteration);
  const double weight = view_loss_.DepthTermWeight(iteration.view.kind, iteration.number);
  if (weight == 0 || !pictures.inv_depth.defined()) return {};
  const Buffer<float> grad = View(grad_inv_depth_, {inv_depth.size(0), inv_depth.size(1)});
  MaskedL1Input in;
  in.rendered = inv_depth.data();
  in.target = pictures.inv_depth.data();
  in.mask = ImageOf(pictures.depth_mask);
  in.sums = depth_sums_.data();
  AddMaskedL1(in, weight, grad, terms);
  return grad;
}

/// The same of alpha.
Buffer<float> CudaViewLoss::AddAlpha(const Iteration& iteration, const Buffer<float>& alpha, LossTerms* terms) {
  const DeviceViewPictures& pictures = Pictures(iteration);
  const double weight = view_loss_.options().alpha_weight;
  if (weight == 0 || !pictures.alpha.defined()) return {};
  const Buffer<float> grad = View(grad_alpha_, {alpha.size(0), alpha.size(1)});
  MaskedL1Input in;
  in.rendered = alpha.data();
  in.target = pictures.alpha.data();
  in.mask = ImageOf(pictures.confidence);
  in.sums = alpha_sums_.data();
  AddMaskedL1(in, weight, grad, terms);
  return grad;
}

ExposureState CudaViewLoss::exposures() const {
  ExposureState state{DownloadMaps(maps_, rows_.views), DownloadMaps(m_, rows_.views), DownloadMaps(v_, rows_.views),
                      std::vector<int64_t>(static_cast<size_t>(rows_.views))};
  steps_.Download(rows_.views, state.steps.data());
  return state;
}

void CudaViewLoss::RestoreExposures(const ExposureState& state) {
  if (rows_.views == 0) return;
  Exposures checked = *view_loss_.exposures();
  checked.Restore(state);  // throws when it is of other photographs
  UploadMaps(state.maps, &maps_);
  UploadMaps(state.m, &m_);
  UploadMaps(state.v, &v_);
  steps_.Upload(state.steps.data(), rows_.views);
  rows_ = {rows_.views, maps_.data(), m_.data(), v_.data(), steps_.data()};
}

}  // namespace oraclegs::cuda
