#include "oraclegs/networks/vggt/input.h"

#include <algorithm>
#include <cmath>

namespace oraclegs::vggt {
namespace {

Image8 OverWhite(const Image8& image) {
  if (image.channels == 3) return image;
  Image8 out{image.width, image.height, 3, std::vector<uint8_t>(size_t{3} * image.width * image.height)};
  for (size_t i = 0; i < out.data.size() / 3; ++i) {
    const int alpha = image.data[4 * i + 3];
    for (size_t c = 0; c < 3; ++c) {
      out.data[3 * i + c] = static_cast<uint8_t>((alpha * image.data[4 * i + c] + (255 - alpha) * 255 + 127) / 255);
    }
  }
  return out;
}

/// Multiple of the patch nearest to `length`, half to even, at least one patch.
int64_t NearestMultiple(int64_t patch, double length) {
  return std::max<int64_t>(patch * static_cast<int64_t>(std::nearbyint(length / static_cast<double>(patch))), patch);
}

InputPlace ResizedSize(const Image8& image, Fit fit, int64_t side, int64_t patch) {
  const double fixed = static_cast<double>(side);
  InputPlace place{side, side, 0, 0};
  if (fit == Fit::kCrop || image.width >= image.height) {
    place.height = NearestMultiple(patch, image.height * (fixed / image.width));
  } else {
    place.width = NearestMultiple(patch, image.width * (fixed / image.height));
  }
  if (fit == Fit::kCrop && place.height > side) place.top = -((place.height - side) / 2);
  return place;
}

/// Tensor [3, H, W] in [0, 1], cropped to at most `side` rows.
Tensor AsTensor(const Image8& image, const InputPlace& place, int64_t side) {
  const Tensor bytes = torch::empty({place.height, place.width, 3}, torch::TensorOptions(torch::kUInt8));
  std::copy(image.data.begin(), image.data.end(), bytes.data_ptr<uint8_t>());
  const Tensor rows = place.top < 0 ? bytes.slice(0, -place.top, -place.top + side) : bytes;
  return rows.permute({2, 0, 1}).to(torch::kFloat) / 255;
}

}  // namespace

Input PrepareInput(const std::vector<Image8>& images, Fit fit, int64_t side, int64_t patch) {
  if (images.empty()) throw ShapeError("PrepareInput: there are no images");
  Input input;
  std::vector<Tensor> views;
  int64_t height = fit == Fit::kPad ? side : 0, width = height;
  for (const Image8& image : images) {
    if (image.width < 1 || image.height < 1 || (image.channels != 3 && image.channels != 4)) {
      throw ShapeError("PrepareInput: an image is {} x {} with {} channels, expected pixels of 3 or 4", image.width,
                       image.height, image.channels);
    }
    const InputPlace place = ResizedSize(image, fit, side, patch);
    const Image8 resized =
        ResizeLikePillow(OverWhite(image), static_cast<int>(place.width), static_cast<int>(place.height));
    views.push_back(AsTensor(resized, place, side));
    input.places.push_back(place);
    height = std::max(height, views.back().size(1));
    width = std::max(width, views.back().size(2));
  }
  input.images = torch::ones({static_cast<int64_t>(images.size()), 3, height, width});
  for (size_t i = 0; i < views.size(); ++i) {
    const int64_t above = (height - views[i].size(1)) / 2, before = (width - views[i].size(2)) / 2;
    input.images[static_cast<int64_t>(i)]
        .slice(1, above, above + views[i].size(1))
        .slice(2, before, before + views[i].size(2))
        .copy_(views[i]);
    input.places[i].top += above;
    input.places[i].left += before;
  }
  return input;
}

}  // namespace oraclegs::vggt
