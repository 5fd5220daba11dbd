#include "oraclegs/validate/tamper.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "oraclegs/core/error.h"
#include "oraclegs/validate/integral.h"

namespace oraclegs {
namespace {

constexpr int kMaxParts = 64;
constexpr double kSmallestPart = 0.03, kLargestPart = 0.25;  // half side, as a share of the image's smaller side
constexpr double kSoftestEdge = 0.3;                         // share of a part's half side
constexpr double kNearby = 0.02, kFar = 0.15;                // displacement, as a share of the larger side

using Color = std::array<float, 3>;

/// A rotated ellipse or box with a soft edge.
struct Part {
  bool box = false;
  double x = 0, y = 0, half_width = 1, half_height = 1, cosine = 1, sine = 0, edge = 0.01;

  static Part Draw(int width, int height, Rng* rng) {
    const double side = std::min(width, height);
    // Sizes are log-uniform: small parts are as frequent as large ones.
    const double size = side * kSmallestPart * std::pow(kLargestPart / kSmallestPart, rng->Uniform());
    const double stretch = std::exp(rng->Uniform(-0.6, 0.6)), angle = rng->Uniform(0, M_PI);
    Part part;
    part.box = rng->Uniform() < 0.4;
    part.x = rng->Uniform(0, width), part.y = rng->Uniform(0, height);
    part.half_width = std::max(1.0, size * stretch), part.half_height = std::max(1.0, size / stretch);
    part.cosine = std::cos(angle), part.sine = std::sin(angle);
    part.edge = rng->Uniform(0.01, kSoftestEdge);
    return part;
  }

  Window Bounds(int width, int height) const {
    const double reach = std::hypot(half_width, half_height);
    const auto from = [](double v) { return std::max(0, static_cast<int>(std::floor(v))); };
    return {std::min(width, from(x - reach)), std::min(height, from(y - reach)), std::min(width, from(x + reach + 1)),
            std::min(height, from(y + reach + 1))};
  }

  /// Weight of a pixel: 1 inside, 0 outside, between along the edge.
  float At(double px, double py) const {
    const double u = std::abs(cosine * (px - x) + sine * (py - y)) / half_width;
    const double v = std::abs(cosine * (py - y) - sine * (px - x)) / half_height;
    const double distance = box ? std::max(u, v) : std::hypot(u, v);
    const double t = std::clamp((1 - distance) / edge, 0.0, 1.0);
    return static_cast<float>(t * t * (3 - 2 * t));
  }
};

int Mirrored(int64_t i, int size) {
  const int64_t period = int64_t{2} * size;
  const int64_t m = ((i % period) + period) % period;
  return static_cast<int>(m < size ? m : period - 1 - m);
}

Color At(const ImageF& image, int64_t x, int64_t y) {
  const float* p = image.row(Mirrored(y, image.height)) + size_t{3} * static_cast<size_t>(Mirrored(x, image.width));
  return {p[0], p[1], p[2]};
}

/// Mean color of windows.
class BoxBlur {
 public:
  explicit BoxBlur(const ImageF& image) : image_(image) {
    for (size_t c = 0; c < 3; ++c) {
      channels_.emplace_back(image.width, image.height, [&](size_t i) { return image.data[3 * i + c]; });
    }
  }
  Color At(int x, int y, int radius) const {
    const Window window = Window::Around(x, y, radius, image_.width, image_.height);
    Color color;
    for (size_t c = 0; c < 3; ++c) color[c] = static_cast<float>(channels_[c].Mean(window));
    return color;
  }

 private:
  const ImageF& image_;
  std::vector<Integral> channels_;
};

/// Replacement content of one part.
class Filling {
 public:
  Filling(TamperKind kind, const ImageF& image, Rng* rng) : kind_(kind) {
    const double side = std::max(image.width, image.height);
    const double distance =
        side * (kind == TamperKind::kDisplaced ? rng->Uniform(kNearby, 4 * kNearby) : rng->Uniform(kFar, 4 * kFar));
    const double angle = rng->Uniform(0, 2 * M_PI);
    dx_ = std::llround(distance * std::cos(angle)), dy_ = std::llround(distance * std::sin(angle));
    radius_ = std::max(1, static_cast<int>(std::min(image.width, image.height) * rng->Uniform(0.01, 0.04)));
    for (size_t c = 0; c < 3; ++c) {
      gain_[c] = static_cast<float>(rng->Uniform(0.6, 1.4));
      offset_[c] = static_cast<float>(rng->Uniform(-0.2, 0.2));
    }
  }

  Color At(const ImageF& image, const ImageF& other, const BoxBlur& blur, int x, int y) const {
    switch (kind_) {
      case TamperKind::kOtherImage:
        return oraclegs::At(other, x + dx_, y + dy_);
      case TamperKind::kElsewhere:
      case TamperKind::kDisplaced:
        return oraclegs::At(image, x + dx_, y + dy_);
      case TamperKind::kBlur:
        return blur.At(x, y, radius_);
      case TamperKind::kTone:
        break;
    }
    Color color = oraclegs::At(image, x, y);
    for (size_t c = 0; c < 3; ++c) color[c] = std::clamp(gain_[c] * color[c] + offset_[c], 0.f, 1.f);
    return color;
  }

 private:
  TamperKind kind_;
  int64_t dx_ = 0, dy_ = 0;
  int radius_ = 1;
  Color gain_ = {}, offset_ = {};
};

}  // namespace

Tampered Tamper(const ImageF& image, const ImageF& other, double share, Rng* rng) {
  if (image.channels != 3 || image.data.empty()) throw ShapeError("Tamper: an image of 3 channels is needed");
  const BoxBlur blur(image);
  Tampered tampered{image, std::vector<float>(image.data.size() / 3, 0.f)};
  const double wanted = share * static_cast<double>(tampered.share.size());
  double replaced = 0;
  for (int part = 0; part < kMaxParts && replaced < wanted; ++part) {
    const Part shape = Part::Draw(image.width, image.height, rng);
    auto kind = static_cast<TamperKind>(rng->Index(kTamperKinds));
    if (kind == TamperKind::kOtherImage && other.data.empty()) kind = TamperKind::kElsewhere;
    const Filling filling(kind, image, rng);
    const Window bounds = shape.Bounds(image.width, image.height);
    for (int y = bounds.y0; y < bounds.y1; ++y) {
      for (int x = bounds.x0; x < bounds.x1; ++x) {
        const float weight = shape.At(x + 0.5, y + 0.5);
        if (weight == 0) continue;
        const size_t i = static_cast<size_t>(y) * static_cast<size_t>(image.width) + static_cast<size_t>(x);
        const Color color = filling.At(image, other, blur, x, y);
        for (size_t c = 0; c < 3; ++c) {
          tampered.rgb.data[3 * i + c] += weight * (color[c] - tampered.rgb.data[3 * i + c]);
        }
        const float before = tampered.share[i];
        tampered.share[i] = std::max(before, weight);
        replaced += static_cast<double>(tampered.share[i] - before);
      }
    }
  }
  return tampered;
}

ImageF UpsideDown(const ImageF& image) {
  ImageF turned = image;
  const size_t pixels = image.data.size() / 3;
  for (size_t i = 0; i < pixels; ++i) {
    for (size_t c = 0; c < 3; ++c) turned.data[3 * i + c] = image.data[3 * (pixels - 1 - i) + c];
  }
  return turned;
}

ImageF Zoomed(const ImageF& image, double factor) {
  ImageF zoomed = image;
  for (int y = 0; y < image.height; ++y) {
    for (int x = 0; x < image.width; ++x) {
      const double u = (x + 0.5 - image.width / 2.0) / factor + image.width / 2.0;
      const double v = (y + 0.5 - image.height / 2.0) / factor + image.height / 2.0;
      const Color color = At(image, static_cast<int64_t>(std::floor(u)), static_cast<int64_t>(std::floor(v)));
      std::copy(color.begin(), color.end(), zoomed.row(y) + size_t{3} * static_cast<size_t>(x));
    }
  }
  return zoomed;
}

}  // namespace oraclegs
