#include "oraclegs/train/cuda/cuda_view_loss.h"

#include <utility>

#include "oraclegs/loss/cuda/masked_l1.h"

namespace oraclegs::cuda {
namespace {

void UploadMaps(const std::vector<ExposureMap>& maps, DeviceArray<float>* to) {
  to->Upload(maps.data()->data(), kExposureNumbers * static_cast<int64_t>(maps.size()));
}

std::vector<ExposureMap> DownloadMaps(const DeviceArray<float>& from, int views) {
  std::vector<ExposureMap> maps(static_cast<size_t>(views));
  if (views > 0) from.Download(kExposureNumbers * static_cast<int64_t>(views), maps.data()->data());
  return maps;
}

/// Queues weight * mean(|rendered - target| * mask) of the planes in `in`; the gradient goes to `grad`.
void QueueMaskedL1(MaskedL1Input in, double weight, const Buffer<float>& grad, LossSums* sums) {
  in.pixels = grad.count();
  const double scale = weight / static_cast<double>(in.pixels);
  in.scale = static_cast<float>(scale);
  in.grad = grad.data();
  RunMaskedL1(in, kStream);
  sums->Add({in.sums, MaskedL1Blocks(in.pixels), 1, scale});
}

}  // namespace

/// A render and the view it is compared with.
struct CudaViewLoss::Rendered {
  const PackedView& view;
  const RenderOutput& out;
  const Buffer<float>& shown;  // the image through the exposure map
  const LossTerms& terms;
};

CudaViewLoss::CudaViewLoss(const LossPlan& plan, DeviceViews views, Device device)
    : plan_(plan), views_(std::move(views)) {
  const auto [pixels, tiles] = LargestOf(plan);
  const auto image = [pixels = pixels, device](int64_t channels) {
    return Buffer<float>::Empty({channels * pixels}, device, "the gradients of the image");
  };
  grad_image_ = image(3);
  grad_inv_depth_ = image(1);
  grad_alpha_ = image(1);
  derivatives_.ReserveExactly(PhotometricDerivatives(pixels, PhotometricChannelsAtOnce(pixels)));
  photometric_sums_.ReserveExactly(tiles);
  depth_sums_.ReserveExactly(MaskedL1Blocks(pixels));
  alpha_sums_.ReserveExactly(MaskedL1Blocks(pixels));
  const std::vector<ExposureMap> start = plan.StartExposures();
  if (start.empty()) return;
  shown_ = image(3);
  exposure_sums_.ReserveExactly(kExposureNumbers * ExposureBlocks(pixels));
  exposure_regularizer_.ReserveExactly(1);
  rows_.views = static_cast<int>(start.size());
  RestoreExposures(Exposures(start).state());
}

RenderGrads CudaViewLoss::operator()(const SampledView& sampled, int64_t iteration, const RenderOutput& out,
                                     LossSums* sums) {
  const LossTerms terms = plan_.Terms(sampled, iteration);
  const Buffer<float> shown = terms.exposure ? ShownThrough(*terms.exposure, out.image) : out.image;
  const Rendered rendered{views_.At(sampled), out, shown, terms};
  RenderGrads grads;
  grads.image = grad_image_.Head(out.image.shape());
  for (const LossTerm& term : terms) Queue(term, rendered, &grads, sums);
  return grads;
}

void CudaViewLoss::Queue(const LossTerm& term, const Rendered& rendered, RenderGrads* grads, LossSums* sums) {
  const auto queue_masked_l1 = [&](const Buffer<float>& plane, const Buffer<float>& grad, double* to) {
    MaskedL1Input in;
    in.rendered = plane.data();
    in.target = rendered.view.Plane(term.target);
    in.mask = rendered.view.Plane(term.mask);
    in.sums = to;
    QueueMaskedL1(in, term.weight, grad, sums);
  };
  switch (term.kind) {
    case TermKind::kPhotometric:
      QueuePhotometric(term, rendered, sums);
      break;
    case TermKind::kExposure:
      QueueExposure(term, rendered, sums);
      break;
    case TermKind::kPerceptual:
      try {
        sums->constant +=
            term.weight * plan_.lpips()(rendered.out.image, rendered.view.lpips_target, term.weight, &grads->image);
      } catch (const OutOfMemory& error) {
        throw OutOfMemory("LPIPS of a proposal: {}; give --set proposal-lpips=0 or raise --downscale", error.what());
      }
      break;
    case TermKind::kInvDepth:
      grads->inv_depth = grad_inv_depth_.Head(rendered.out.inv_depth.shape());
      queue_masked_l1(rendered.out.inv_depth, grads->inv_depth, depth_sums_.data());
      break;
    case TermKind::kAlpha:
      grads->alpha = grad_alpha_.Head(rendered.out.alpha.shape());
      queue_masked_l1(rendered.out.alpha, grads->alpha, alpha_sums_.data());
      break;
  }
}

Buffer<float> CudaViewLoss::ShownThrough(int exposure, const Buffer<float>& image) {
  const Buffer<float> shown = shown_.Head(image.shape());
  ExposurePixels in;
  in.pixels = image.size(0) * image.size(1);
  in.map = rows_.maps + kExposureNumbers * exposure;
  in.image = image.data();
  in.shown = shown.data();
  RunExposureApply(in, kStream);
  return shown;
}

void CudaViewLoss::QueuePhotometric(const LossTerm& term, const Rendered& rendered, LossSums* sums) {
  PhotometricInput in;
  in.height = static_cast<int>(rendered.shown.size(0));
  in.width = static_cast<int>(rendered.shown.size(1));
  in.render = rendered.shown.data();
  in.target = rendered.view.Plane(term.target);
  in.confidence = rendered.view.Plane(term.mask);
  in.meaning = term.mask_meaning;
  const double entries = 3.0 * in.width * in.height;
  in.l1_scale = static_cast<float>(term.photometric.l1 / entries);
  in.dssim_scale = static_cast<float>(term.photometric.dssim / entries);
  const int64_t tiles = PhotometricTiles(in.width, in.height);
  const bool together = PhotometricDerivatives(int64_t{in.width} * in.height, 3) <= derivatives_.capacity();
  RunPhotometric(in, {photometric_sums_.data(), derivatives_.data(), together ? 3 : 1, grad_image_.data()}, kStream);
  const PhotometricSums* parts = photometric_sums_.data();
  sums->Add({&parts->l1, tiles, 2, static_cast<double>(term.photometric.l1) / entries});
  sums->Add({&parts->dssim, tiles, 2, static_cast<double>(term.photometric.dssim) / entries});
}

void CudaViewLoss::QueueExposure(const LossTerm& term, const Rendered& rendered, LossSums* sums) {
  const int view = *rendered.terms.exposure;
  ExposurePixels pixels;
  pixels.pixels = rendered.out.image.size(0) * rendered.out.image.size(1);
  pixels.map = rows_.maps + kExposureNumbers * view;
  pixels.image = rendered.out.image.data();
  pixels.grad = grad_image_.data();
  pixels.sums = exposure_sums_.data();
  RunExposureBackward(pixels, kStream);
  ExposureStepInput step;
  step.rows = rows_;
  step.view = view;
  step.sums = exposure_sums_.data();
  step.blocks = ExposureBlocks(pixels.pixels);
  step.learning_rate = rendered.terms.exposure_rate;
  step.weight = term.weight;
  step.moves = rendered.terms.exposure_rate > 0;
  step.regularizer = exposure_regularizer_.data();
  RunExposureStep(step, kStream);
  sums->Add({exposure_regularizer_.data(), 1, 1, 1});
}

ExposureState CudaViewLoss::exposures() const {
  ExposureState state{DownloadMaps(maps_, rows_.views), DownloadMaps(m_, rows_.views), DownloadMaps(v_, rows_.views),
                      std::vector<int64_t>(static_cast<size_t>(rows_.views))};
  steps_.Download(rows_.views, state.steps.data());
  return state;
}

void CudaViewLoss::RestoreExposures(const ExposureState& state) {
  if (rows_.views == 0) return;
  Exposures checked(plan_.StartExposures());
  checked.Restore(state);  // throws when it is of other photos
  UploadMaps(state.maps, &maps_);
  UploadMaps(state.m, &m_);
  UploadMaps(state.v, &v_);
  steps_.Upload(state.steps.data(), rows_.views);
  rows_ = {rows_.views, maps_.data(), m_.data(), v_.data(), steps_.data()};
}

}  // namespace oraclegs::cuda
