#include "oraclegs/validate/comparison.h"

#include <cmath>

#include "oraclegs/core/error.h"
#include "oraclegs/validate/integral.h"

namespace oraclegs {
namespace {

constexpr int kNear = 3, kWideParts = 20, kWiderParts = 10;  // half side of a window; image side / window
constexpr double kNoTexture = 0.01;                          // deviation of brightness below which there is no texture
constexpr double kMinDistance = 0.005;                       // smallest distance of colors

float LogDistance(double distance) { return static_cast<float>(std::log(kMinDistance + std::max(0.0, distance))); }

/// Sums over the brightness of two images, for the moments of their windows.
class Moments {
 public:
  Moments(const ImageF& a, const ImageF& b)
      : a_(a.width, a.height, [&](size_t i) { return Brightness(a, i); }),
        b_(a.width, a.height, [&](size_t i) { return Brightness(b, i); }),
        aa_(a.width, a.height, [&](size_t i) { return Brightness(a, i) * Brightness(a, i); }),
        bb_(a.width, a.height, [&](size_t i) { return Brightness(b, i) * Brightness(b, i); }),
        ab_(a.width, a.height, [&](size_t i) { return Brightness(a, i) * Brightness(b, i); }) {}

  struct Of {
    double deviation_a, deviation_b, covariance;
    /// 1 - SSIM's structure term: windows without texture agree.
    float Structure() const {
      return static_cast<float>(1 - (covariance + kNoTexture * kNoTexture) /
                                        (deviation_a * deviation_b + kNoTexture * kNoTexture));
    }
    float Sharpness() const {
      return static_cast<float>(std::log((deviation_a + kNoTexture) / (deviation_b + kNoTexture)));
    }
  };
  Of In(const Window& window) const {
    const double a = a_.Mean(window), b = b_.Mean(window);
    return {std::sqrt(std::max(0.0, aa_.Mean(window) - a * a)), std::sqrt(std::max(0.0, bb_.Mean(window) - b * b)),
            ab_.Mean(window) - a * b};
  }

 private:
  static double Brightness(const ImageF& image, size_t i) {
    const float* p = &image.data[3 * i];
    return static_cast<double>(0.299f * p[0] + 0.587f * p[1] + 0.114f * p[2]);
  }
  Integral a_, b_, aa_, bb_, ab_;
};

/// Sums over the differences of two images' colors.
class Differences {
 public:
  Differences(const ImageF& a, const ImageF& b)
      : red_(a.width, a.height, [&](size_t i) { return a.data[3 * i] - b.data[3 * i]; }),
        green_(a.width, a.height, [&](size_t i) { return a.data[3 * i + 1] - b.data[3 * i + 1]; }),
        blue_(a.width, a.height, [&](size_t i) { return a.data[3 * i + 2] - b.data[3 * i + 2]; }) {}

  float Shift(const Window& window) const {
    return LogDistance(std::sqrt((Square(red_, window) + Square(green_, window) + Square(blue_, window)) / 3));
  }

 private:
  static double Square(const Integral& channel, const Window& window) {
    return channel.Mean(window) * channel.Mean(window);
  }
  Integral red_, green_, blue_;
};

double ColorDistance(const ImageF& a, const ImageF& b, size_t i) {
  double squares = 0;
  for (size_t c = 3 * i; c < 3 * i + 3; ++c) {
    const double d = static_cast<double>(a.data[c]) - static_cast<double>(b.data[c]);
    squares += d * d;
  }
  return std::sqrt(squares / 3);
}

}  // namespace

std::vector<Comparison> Compare(const ImageF& proposal, const ImageF& shown) {
  const int width = proposal.width, height = proposal.height;
  if (width != shown.width || height != shown.height || proposal.data.size() != shown.data.size()) {
    throw ShapeError("Compare: {} x {} with {} x {} pixels", width, height, shown.width, shown.height);
  }
  const int wide = std::max(kNear + 1, std::min(width, height) / kWideParts);
  const int wider = std::max(kNear + 2, std::min(width, height) / kWiderParts);
  const Integral distance(width, height, [&](size_t i) { return ColorDistance(proposal, shown, i); });
  const Differences differences(proposal, shown);
  const Moments moments(proposal, shown);
  std::vector<Comparison> compared;
  compared.reserve(static_cast<size_t>(width) * static_cast<size_t>(height));
  for (int y = 0; y < height; ++y) {
    for (int x = 0; x < width; ++x) {
      const Window near = Window::Around(x, y, kNear, width, height);
      const Window around = Window::Around(x, y, wide, width, height);
      const Moments::Of of_around = moments.In(around);
      compared.push_back({LogDistance(distance.Mean(around)), differences.Shift(near), differences.Shift(around),
                          differences.Shift(Window::Around(x, y, wider, width, height)), of_around.Structure(),
                          moments.In(near).Sharpness(), of_around.Sharpness()});
    }
  }
  return compared;
}

}  // namespace oraclegs
