#include "oraclegs/image/image.h"

#include <algorithm>
#include <atomic>
#include <cmath>

#include "oraclegs/core/error.h"
#include "oraclegs/core/parallel.h"

namespace oraclegs {
namespace {

constexpr int64_t kRowsPerTask = 16;
constexpr int64_t kMega = 1'000'000;

std::atomic<int64_t> g_max_megapixels = kUsualMaxMegapixels;

/// The old pixels that make one new one: weights[i] belongs to pixel first + i.
struct Taps {
  int first = 0;
  std::vector<float> weights;
};

/// Overlap of the new pixel with each old one, as a share of the new pixel.
Taps AreaTaps(int i, int old_size, int new_size) {
  const double scale = static_cast<double>(old_size) / new_size;
  const double begin = i * scale, end = std::min<double>((i + 1) * scale, old_size);
  Taps taps{static_cast<int>(begin), {}};
  for (int k = taps.first; k < old_size && k < end; ++k) {
    taps.weights.push_back(static_cast<float>((std::min<double>(k + 1, end) - std::max<double>(k, begin)) / scale));
  }
  return taps;
}

Taps LinearTaps(int i, int old_size, int new_size) {
  const double at = std::clamp((i + 0.5) * old_size / new_size - 0.5, 0., old_size - 1.);
  const int first = std::min(static_cast<int>(at), std::max(0, old_size - 2));
  const float second = static_cast<float>(at - first);
  if (second == 0) return {first, {1.f}};
  return {first, {1 - second, second}};
}

std::vector<Taps> AxisTaps(int old_size, int new_size) {
  std::vector<Taps> taps;
  for (int i = 0; i < new_size; ++i) {
    taps.push_back(new_size > old_size ? LinearTaps(i, old_size, new_size) : AreaTaps(i, old_size, new_size));
  }
  return taps;
}

void ReduceColumns(const float* row, const std::vector<Taps>& taps, int channels, float* out) {
  for (const Taps& tap : taps) {
    for (int c = 0; c < channels; ++c) {
      const float* in = row + static_cast<size_t>(tap.first) * channels + c;
      float sum = 0;
      for (size_t k = 0; k < tap.weights.size(); ++k) sum += tap.weights[k] * in[k * channels];
      *out++ = sum;
    }
  }
}

constexpr int kWeightBits = 22;

/// Cubic convolution with parameter -1/2.
double Cubic(double x) {
  constexpr double kA = -0.5;
  x = std::abs(x);
  if (x < 1) return ((kA + 2) * x - (kA + 3)) * x * x + 1;
  if (x < 2) return kA * (((x - 5) * x + 8) * x - 4);
  return 0;
}

/// Taps of one output sample, in fixed point.
struct CubicTaps {
  int begin = 0;
  std::vector<int64_t> weights;
};

std::vector<CubicTaps> MakeCubicTaps(int n, int m) {
  const double step = static_cast<double>(n) / m, stretch = std::max(step, 1.0), reach = 2 * stretch;
  std::vector<CubicTaps> out(static_cast<size_t>(m));
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
    CubicTaps& taps = out[static_cast<size_t>(i)];
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
  const std::vector<CubicTaps> all = MakeCubicTaps(in.width, width);
  ParallelBlocks(in.height, kRowsPerTask, [&](int64_t begin, int64_t end) {
    for (int64_t y = begin; y < end; ++y) {
      const uint8_t* row = in.data.data() + y * in.width * in.channels;
      uint8_t* to = out.data.data() + y * width * in.channels;
      for (const CubicTaps& taps : all) {
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
  const std::vector<CubicTaps> all = MakeCubicTaps(in.height, height);
  const size_t stride = static_cast<size_t>(in.width) * in.channels;
  ParallelBlocks(height, kRowsPerTask, [&](int64_t begin, int64_t end) {
    for (int64_t y = begin; y < end; ++y) {
      const CubicTaps& taps = all[static_cast<size_t>(y)];
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

}  // namespace

void SetMaxMegapixels(int64_t megapixels) { g_max_megapixels = megapixels; }

void CheckImageSize(int64_t width, int64_t height, uint64_t possible, const std::string& file) {
  if (width <= 0 || height <= 0) throw InputError("{}: its header says {} x {} pixels", file, width, height);
  const int64_t most = g_max_megapixels * kMega;
  if (width > most || height > most || width * height > most) {
    throw InputError("{}: its header says {} x {} pixels, at most {} million are read; make it smaller, or give {}",
                     file, width, height, most / kMega, "a larger --max-megapixels");
  }
  if (static_cast<uint64_t>(width * height) > possible) {
    throw InputError(
        "{}: its header says {} x {} pixels, more than its bytes can hold; it is incomplete, copy it again", file,
        width, height);
  }
}

ImageF ToFloat(const Image8& image) {
  ImageF result{image.width, image.height, image.channels, std::vector<float>(image.data.size())};
  std::transform(image.data.begin(), image.data.end(), result.data.begin(),
                 [](uint8_t value) { return static_cast<float>(value) / 255; });
  return result;
}

Image8 ToImage8(const ImageF& image) {
  Image8 result{image.width, image.height, image.channels, std::vector<uint8_t>(image.data.size())};
  std::transform(image.data.begin(), image.data.end(), result.data.begin(), [](float value) {
    const float clamped = value > 0 ? std::min(value, 1.f) : 0.f;  // not a number becomes 0
    return static_cast<uint8_t>(255 * clamped + 0.5f);
  });
  return result;
}

ImageF ResizeArea(const ImageF& image, int width, int height) {
  if (width <= 0 || height <= 0 || image.width <= 0 || image.height <= 0) {
    throw ShapeError("ResizeArea: {} x {} to {} x {}", image.width, image.height, width, height);
  }
  if (width == image.width && height == image.height) return image;
  const std::vector<Taps> columns = AxisTaps(image.width, width), rows = AxisTaps(image.height, height);
  ImageF result{width, height, image.channels, {}};
  result.data.resize(static_cast<size_t>(width) * static_cast<size_t>(height) * static_cast<size_t>(image.channels));
  const size_t row_values = static_cast<size_t>(image.width) * static_cast<size_t>(image.channels);
  ParallelBlocks(height, kRowsPerTask, [&](int64_t begin, int64_t end) {
    std::vector<float> sum(row_values);
    for (int y = static_cast<int>(begin); y < end; ++y) {
      std::fill(sum.begin(), sum.end(), 0.f);
      const Taps& tap = rows[static_cast<size_t>(y)];
      for (size_t k = 0; k < tap.weights.size(); ++k) {
        const float* in = image.row(tap.first + static_cast<int>(k));
        const float weight = tap.weights[k];
        for (size_t i = 0; i < row_values; ++i) sum[i] += weight * in[i];
      }
      ReduceColumns(sum.data(), columns, image.channels, result.row(y));
    }
  });
  return result;
}

Image8 ResizeLikePillow(const Image8& image, int width, int height) {
  if (width < 1 || height < 1 || image.width < 1 || image.height < 1) {
    throw ShapeError("ResizeLikePillow: {} x {} to {} x {}", image.width, image.height, width, height);
  }
  Image8 out = image;
  if (width != image.width) out = ResizeWidth(out, width);
  if (height != image.height) out = ResizeHeight(out, height);
  return out;
}

ImageF ResizeRgbLikePillow(const ImageF& image, int width, int height) {
  constexpr float kRoundOff = 1e-3f;  // of a whole byte that was divided by 255
  ImageF small = ResizeArea(image, width, height);
  const size_t channels = static_cast<size_t>(image.channels);
  Image8 rgb{image.width, image.height, 3, {}};
  for (size_t i = 0; i < image.data.size(); i += channels) {
    for (size_t c = 0; c < 3; ++c) {
      const float byte = std::floor(255 * image.data[i + c] + kRoundOff);
      rgb.data.push_back(static_cast<uint8_t>(std::clamp(byte, 0.f, 255.f)));
    }
  }
  const Image8 bytes = ResizeLikePillow(rgb, width, height);
  for (size_t i = 0; i < bytes.data.size(); ++i) {
    small.data[i / 3 * channels + i % 3] = static_cast<float>(bytes.data[i]) / 255;
  }
  return small;
}

}  // namespace oraclegs
