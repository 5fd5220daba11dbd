#include "oraclegs/networks/seva/conditioning.h"

#include <memory>

namespace oraclegs::seva {
namespace {

/// Inputs of one call of the UNet: what is appended to its latents, and the prepared conditioning.
struct Half {
  Tensor concat;
  Conditioning conditioning;

  Tensor Run(const Unet& unet, const Tensor& scaled, int64_t index) const {
    const Tensor steps = at::full({scaled.size(0)}, index, scaled.options().dtype(torch::kLong));
    return Forward(unet, at::cat({scaled, concat}, 1), steps, conditioning);
  }
};

}  // namespace

NetworkInputs MakeInputs(const Frames& frames, torch::Device device) {
  const size_t count = frames.views.size();
  if (count == 0 || frames.given.size() != count || frames.latents.size() != count ||
      frames.embeddings.size() != count) {
    throw ShapeError("MakeInputs: {} views, {} marks, {} latents and {} embeddings", count, frames.given.size(),
                     frames.latents.size(), frames.embeddings.size());
  }
  const auto options = torch::TensorOptions(device).dtype(torch::kFloat);
  const auto rows = static_cast<int64_t>(count);
  NetworkInputs inputs;
  inputs.given = at::zeros({rows, 5, frames.height, frames.width}, options);
  Tensor sum;
  int64_t given = 0;
  for (size_t t = 0; t < count; ++t) {
    if (!frames.given[t]) continue;
    Tensor row = inputs.given[static_cast<int64_t>(t)];
    row.slice(0, 0, 4).copy_(frames.latents[t].squeeze(0));
    row.slice(0, 4).fill_(1);
    const Tensor embedding = frames.embeddings[t].to(options);
    sum = given++ == 0 ? embedding.clone() : sum.add_(embedding);
  }
  if (given == 0) throw ShapeError("MakeInputs: no frame is given");
  inputs.mask = inputs.given.slice(1, 4);
  inputs.rays = PlueckerMaps(frames.views, frames.height, frames.width).to(device);
  inputs.context = (sum / static_cast<double>(given)).unsqueeze(0).expand({rows, 1, -1});
  return inputs;
}

Network MakeNetwork(const Unet& unet, const NetworkInputs& inputs, Halves halves) {
  const int64_t frames = inputs.rays.size(0), height = inputs.rays.size(2), width = inputs.rays.size(3);
  const auto half = [&](const Tensor& mask, const Tensor& context) {
    const int64_t sequences = mask.size(0) / frames;
    const Tensor rays = inputs.rays.repeat({sequences, 1, 1, 1});
    return std::make_shared<const Half>(
        Half{at::cat({mask, rays}, 1), Prepare(unet, {context, rays, frames, height, width})});
  };
  const Tensor no_mask = at::zeros_like(inputs.mask), no_context = at::zeros_like(inputs.context);
  if (halves == Halves::kBatched) {
    const auto both = half(at::cat({no_mask, inputs.mask}, 0), at::cat({no_context, inputs.context}, 0));
    return [&unet, both](const Tensor& scaled, int64_t index) { return both->Run(unet, scaled, index); };
  }
  const auto first = half(no_mask, no_context), second = half(inputs.mask, inputs.context);
  return [&unet, first, second, frames](const Tensor& scaled, int64_t index) {
    const Tensor plain = first->Run(unet, scaled.slice(0, 0, frames), index);
    return at::cat({plain, second->Run(unet, scaled.slice(0, frames), index)}, 0);
  };
}

}  // namespace oraclegs::seva
