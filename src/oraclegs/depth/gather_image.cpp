#include "oraclegs/depth/patch_cost.h"

#include <algorithm>
#include <cmath>

namespace oraclegs {

GatherImage Pack(const ImageF& image) {
  GatherImage packed{image.width, image.height, {}};
  const int width = image.width, height = image.height, channels = image.channels;
  for (int c = 0; c < channels; ++c) {
    const auto value = [&](int x, int y) {
      const float v = image.row(std::min(y, height - 1))[std::min(x, width - 1) * channels + c];
      return static_cast<uint32_t>(std::lround(255 * std::clamp(v, 0.f, 1.f)));
    };
    std::vector<uint32_t> words(static_cast<size_t>(width) * height);
    for (int y = 0; y < height; ++y) {
      for (int x = 0; x < width; ++x) {
        words[static_cast<size_t>(y) * width + x] =
            value(x, y) | value(x + 1, y) << 8 | value(x, y + 1) << 16 | value(x + 1, y + 1) << 24;
      }
    }
    packed.channels.push_back(std::move(words));
  }
  return packed;
}

ImageF Luma(const ImageF& rgb) {
  ImageF luma{rgb.width, rgb.height, 1, std::vector<float>(static_cast<size_t>(rgb.width) * rgb.height)};
  for (size_t i = 0; i < luma.data.size(); ++i) {
    luma.data[i] = 0.299f * rgb.data[3 * i] + 0.587f * rgb.data[3 * i + 1] + 0.114f * rgb.data[3 * i + 2];
  }
  return luma;
}

}  // namespace oraclegs
