#include "oraclegs/camera/undistort.h"

#include <algorithm>
#include <cmath>

#include "oraclegs/camera/distortion_models.h"
#include "oraclegs/core/error.h"
#include "oraclegs/core/parallel.h"

namespace oraclegs {
namespace {

constexpr double kMinMagnification = 0.2, kMaxMagnification = 5;
constexpr int kBisections = 45;  // halves the range to below one rounding step
constexpr size_t kCoarseStep = 16;
constexpr int64_t kRowsPerTask = 8;

/// Centers of the outermost pixels.
std::vector<Eigen::Vector2d> BorderPixels(int width, int height) {
  std::vector<Eigen::Vector2d> pixels;
  for (int x = 0; x < width; ++x) {
    pixels.emplace_back(x + 0.5, 0.5);
    pixels.emplace_back(x + 0.5, height - 0.5);
  }
  for (int y = 0; y < height; ++y) {
    pixels.emplace_back(0.5, y + 0.5);
    pixels.emplace_back(width - 0.5, y + 0.5);
  }
  return pixels;
}

/// Finds the smallest magnification at which the source image shows what each pixel shows.
class MagnificationSearch {
 public:
  explicit MagnificationSearch(const Intrinsics& intrinsics) : intrinsics_(intrinsics), map_(intrinsics) {}

  /// Raises the magnification as far as this pixel needs it.
  void Include(const Eigen::Vector2d& pixel) {
    if (Sees(pixel, smallest_)) return;
    double low = smallest_, high = kMaxMagnification;
    if (!Sees(pixel, high)) low = high;
    for (int i = 0; i < kBisections && low < high; ++i) {
      const double middle = (low + high) / 2;
      (Sees(pixel, middle) ? high : low) = middle;
    }
    smallest_ = high;
  }
  double smallest() const { return smallest_; }

 private:
  bool Sees(const Eigen::Vector2d& pixel, double magnification) const {
    return map_.Sees((pixel.x() - intrinsics_.cx()) / (magnification * intrinsics_.fx()),
                     (pixel.y() - intrinsics_.cy()) / (magnification * intrinsics_.fy()));
  }

  const Intrinsics& intrinsics_;
  DistortionMap map_;
  double smallest_ = kMinMagnification;
};

/// Between which two pixels of an axis a position lies; past the outermost centers the border is repeated.
struct Between {
  Between(double position, int size) {
    const double last = size - 1;
    const double at = position > 0.5 ? std::min(position - 0.5, last) : 0;  // not a number becomes 0
    low = static_cast<int>(at);
    high = std::min(low + 1, size - 1);
    high_weight = static_cast<float>(at - low);
  }
  int low, high;
  float high_weight;  ///< weight of `high`
};

/// Bilinear; kChannels = 0 stands for any number.
template <int kChannels>
void Sample(const ImageF& source, double u, double v, float* out) {
  const int channels = kChannels > 0 ? kChannels : source.channels;
  const Between x(u, source.width), y(v, source.height);
  const float* top = source.row(y.low);
  const float* bottom = source.row(y.high);
  const int left = x.low * channels, right = x.high * channels;
  for (int c = 0; c < channels; ++c) {
    const float above = top[left + c] + x.high_weight * (top[right + c] - top[left + c]);
    const float below = bottom[left + c] + x.high_weight * (bottom[right + c] - bottom[left + c]);
    out[c] = above + y.high_weight * (below - above);
  }
}

using SampleFunction = void (*)(const ImageF&, double, double, float*);

SampleFunction SampleFor(int channels) {
  if (channels == 3) return Sample<3>;
  return channels == 4 ? Sample<4> : Sample<0>;
}

}  // namespace

Camera UndistortedCamera(const Intrinsics& intrinsics) {
  Camera camera{intrinsics.width,
                intrinsics.height,
                intrinsics.fx(),
                intrinsics.fy(),
                intrinsics.cx(),
                intrinsics.cy(),
                Eigen::Isometry3d::Identity()};
  const bool has_axis = intrinsics.cx() >= 0 && intrinsics.cx() <= intrinsics.width && intrinsics.cy() >= 0 &&
                        intrinsics.cy() <= intrinsics.height;
  if (intrinsics.IsPinhole() || !has_axis) return camera;
  MagnificationSearch search(intrinsics);
  const auto pixels = BorderPixels(intrinsics.width, intrinsics.height);
  // A coarse pass first: it settles most of the value, and the second then bisects for few pixels.
  for (size_t i = 0; i < pixels.size(); i += kCoarseStep) search.Include(pixels[i]);
  for (const auto& pixel : pixels) search.Include(pixel);
  camera.fx *= search.smallest();
  camera.fy *= search.smallest();
  return camera;
}

UndistortedImage Undistort(const ImageF& source, const Intrinsics& intrinsics, const Camera& target) {
  if (source.width != intrinsics.width || source.height != intrinsics.height) {
    throw ShapeError("Undistort: the image is {} x {}, the camera {} x {}", source.width, source.height,
                     intrinsics.width, intrinsics.height);
  }
  const DistortionMap map(intrinsics);
  const SampleFunction sample = SampleFor(source.channels);
  const size_t pixels = static_cast<size_t>(target.width) * static_cast<size_t>(target.height);
  UndistortedImage result{{target.width, target.height, source.channels, {}}, std::vector<uint8_t>(pixels, 0)};
  result.image.data.resize(pixels * static_cast<size_t>(source.channels));
  ParallelBlocks(target.height, kRowsPerTask, [&](int64_t begin, int64_t end) {
    for (int y = static_cast<int>(begin); y < end; ++y) {
      float* out = result.image.row(y);
      uint8_t* valid = result.valid.data() + static_cast<size_t>(y) * static_cast<size_t>(target.width);
      for (int x = 0; x < target.width; ++x, out += source.channels) {
        double u = 0, v = 0;
        if (!map.Project((x + 0.5 - target.cx) / target.fx, (y + 0.5 - target.cy) / target.fy, &u, &v)) continue;
        valid[x] = u >= 0 && u <= source.width && v >= 0 && v <= source.height;
        sample(source, u, v, out);
      }
    }
  });
  if (std::find(result.valid.begin(), result.valid.end(), 0) == result.valid.end()) result.valid.clear();
  return result;
}

}  // namespace oraclegs
