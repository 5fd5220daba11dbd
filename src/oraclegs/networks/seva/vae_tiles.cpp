#include "oraclegs/networks/seva/vae_tiles.h"

#include <algorithm>

namespace oraclegs::seva {
namespace {

/// Ramp from 0 to 1 over the middle half of `overlap` pixels, at the center of pixel `i`.
double Ramp(int64_t i, int64_t overlap) {
  const double margin = 0.25 * static_cast<double>(overlap);
  return std::clamp((static_cast<double>(i) + 0.5 - margin) / (static_cast<double>(overlap) - 2 * margin), 0.0, 1.0);
}

void AddTile(const Tensor& image, const Tensor& tile, const Tensor& rows, const Tensor& columns, at::IntArrayRef at) {
  const Tensor weight = rows.view({-1, 1}) * columns.view({1, -1});
  image.narrow(2, at[0], rows.size(0)).narrow(3, at[1], columns.size(0)).addcmul_(tile, weight);
}

}  // namespace

TiledAxis TileAxis(int64_t length, const VaeTiles& tiles, int64_t pixels_per_latent) {
  if (tiles.side < 1 || tiles.overlap < 1 || 2 * tiles.overlap > tiles.side) {
    throw ShapeError(
        "DecodeTiled: tiles of {} with an overlap of {}, expected an overlap of at least 1 and at most half",
        tiles.side, tiles.overlap);
  }
  TiledAxis axis;
  axis.side = std::min(length, tiles.side);
  const int64_t step = tiles.side - tiles.overlap;
  const int64_t count = 1 + (length - axis.side + step - 1) / step;
  for (int64_t i = 0; i < count; ++i) {
    axis.starts.push_back(count == 1 ? 0 : i * (length - axis.side) / (count - 1));  // evenly, from border to border
  }
  const int64_t pixels = axis.side * pixels_per_latent;
  const Tensor sum = at::zeros({length * pixels_per_latent}, torch::kDouble);
  std::vector<Tensor> weights;
  for (size_t t = 0; t < axis.starts.size(); ++t) {
    weights.push_back(at::ones({pixels}, torch::kDouble));
    double* w = weights.back().data_ptr<double>();
    const auto shared = [&](size_t left) {
      return (axis.starts[left] + axis.side - axis.starts[left + 1]) * pixels_per_latent;
    };
    const int64_t before = t > 0 ? shared(t - 1) : 0, behind = t + 1 < axis.starts.size() ? shared(t) : 0;
    for (int64_t i = 0; i < before; ++i) w[i] *= Ramp(i, before);
    for (int64_t i = 0; i < behind; ++i) w[pixels - 1 - i] *= Ramp(i, behind);
    sum.narrow(0, axis.starts[t] * pixels_per_latent, pixels).add_(weights.back());
  }
  for (size_t t = 0; t < weights.size(); ++t) {
    weights[t].div_(sum.narrow(0, axis.starts[t] * pixels_per_latent, pixels));  // where three tiles meet
  }
  axis.weights = at::stack(weights).to(torch::kFloat);
  return axis;
}

Tensor DecodeTiled(const Vae& vae, const Tensor& latents, const VaeTiles& tiles) {
  RequireLatents("DecodeTiled", latents, vae.config);
  const int64_t scale = vae.config.downscale(), height = latents.size(2), width = latents.size(3);
  const auto options = vae.decoder.conv_out.weight.options().dtype(torch::kFloat);
  const TiledAxis rows = TileAxis(height, tiles, scale), columns = TileAxis(width, tiles, scale);
  const Tensor row_weights = rows.weights.to(options), column_weights = columns.weights.to(options);
  const Tensor images = at::zeros({latents.size(0), 3, scale * height, scale * width}, options);
  for (int64_t i = 0; i < latents.size(0); ++i) {
    const Tensor middle = DecodeMiddle(vae.decoder, latents.slice(0, i, i + 1) / vae.config.latent_scale);
    for (size_t r = 0; r < rows.starts.size(); ++r) {
      for (size_t c = 0; c < columns.starts.size(); ++c) {
        const Tensor part = middle.narrow(2, rows.starts[r], rows.side).narrow(3, columns.starts[c], columns.side);
        const Tensor tile = DecodeLevels(vae.decoder, part.contiguous()).to(torch::kFloat);
        AddTile(images.slice(0, i, i + 1), tile, row_weights[static_cast<int64_t>(r)],
                column_weights[static_cast<int64_t>(c)], {scale * rows.starts[r], scale * columns.starts[c]});
      }
    }
  }
  return images;
}

}  // namespace oraclegs::seva
