#include "oraclegs/networks/vggt/input.h"

#include <algorithm>
#include <cmath>

#include "oraclegs/core/parallel.h"

namespace oraclegs::vggt {
namespace {

constexpr int kWeightBits = 22;
constexpr int kRowsAtOnce = 16;

/// Cubic convolution with parameter -1/2.
double Cubic(double x) {
  constexpr double kA = -0.5;
  x = std::abs(x);
  if (x < 1) return ((kA + 2) * x - (kA + 3)) * x * x + 1;
  if (x < 2) return kA * (((x - 5) * x + 8) * x - 4);
  return 0;
}

/// The taps of one output sample, in fixed point.
struct Taps {
  int begin = 0;
  std::vector<int64_t> weights;
};

std::vector<Taps> MakeTaps(int n, int m) {
  const double step = static_cast<double>(n) / m, stretch = std::max(step, 1.0), reach = 2 * stretch;
  std::vector<Taps> out(static_cast<size_t>(m));
  for (int i = 0; i < m; ++i) {
    const double center = (i + 0.5) * step;
    const int low = std::max(static_cast<int>(center - reach + 0.5), 0);
    const int high = std::min(static_cast<int>(center + reach + 0.5), n);
    std::vector<double> weights;
    double sum = 0;
    for (int j = low; j < high; ++j) {
      weights.push_back(Cubic((j + 0.5 - center) / stretch));
      sum += weights.back();
    }
    Taps& taps = out[static_cast<size_t>(i)];
    taps.begin = low;
    for (const double w : weights) taps.weights.push_back(std::llround(w / sum * (1 << kWeightBits)));
  }
  return out;
}

uint8_t Rounded(int64_t fixed) {
  return static_cast<uint8_t>(std::clamp<int64_t>((fixed + (int64_t{1} << (kWeightBits - 1))) >> kWeightBits, 0, 255));
}

Image8 Sized(int width, int height, int channels) {
  return {width, height, channels, std::vector<uint8_t>(static_cast<size_t>(width) * height * channels)};
}

Image8 ResizeWidth(const Image8& in, int width) {
  Image8 out = Sized(width, in.height, in.channels);
  const std::vector<Taps> all = MakeTaps(in.width, width);
  ParallelBlocks(in.height, kRowsAtOnce, [&](int64_t begin, int64_t end) {
    for (int64_t y = begin; y < end; ++y) {
      const uint8_t* row = in.data.data() + y * in.width * in.channels;
      uint8_t* to = out.data.data() + y * width * in.channels;
      for (const Taps& taps : all) {
        for (int c = 0; c < in.channels; ++c) {
          int64_t sum = 0;
          for (size_t j = 0; j < taps.weights.size(); ++j) {
            sum += taps.weights[j] * row[(static_cast<size_t>(taps.begin) + j) * in.channels + c];
          }
          *to++ = Rounded(sum);
        }
      }
    }
  });
  return out;
}

Image8 ResizeHeight(const Image8& in, int height) {
  Image8 out = Sized(in.width, height, in.channels);
  const std::vector<Taps> all = MakeTaps(in.height, height);
  const size_t stride = static_cast<size_t>(in.width) * in.channels;
  ParallelBlocks(height, kRowsAtOnce, [&](int64_t begin, int64_t end) {
    for (int64_t y = begin; y < end; ++y) {
      const Taps& taps = all[static_cast<size_t>(y)];
      for (size_t x = 0; x < stride; ++x) {
        int64_t sum = 0;
        for (size_t j = 0; j < taps.weights.size(); ++j) {
          sum += taps.weights[j] * in.data[(static_cast<size_t>(taps.begin) + j) * stride + x];
        }
        out.data[static_cast<size_t>(y) * stride + x] = Rounded(sum);
      }
    }
  });
  return out;
}

Image8 OverWhite(const Image8& image) {
  if (image.channels == 3) return image;
  Image8 out = Sized(image.width, image.height, 3);
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

Image8 ResizeLikePillow(const Image8& image, int width, int height) {
  if (width < 1 || height < 1 || image.width < 1 || image.height < 1) {
    throw ShapeError("ResizeLikePillow: {} x {} to {} x {}", image.width, image.height, width, height);
  }
  Image8 out = image;
  if (width != image.width) out = ResizeWidth(out, width);
  if (height != image.height) out = ResizeHeight(out, height);
  return out;
}

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
