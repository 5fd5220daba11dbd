#include "oraclegs/render/recolor.h"

namespace oraclegs {
namespace {

struct SupportClassLook {
  const char* name;
  std::array<uint8_t, 3> color;
  float from;  // lowest support
};
// Blue and sky blue, yellow, vermilion: cold colors are seen, warm ones are not.
constexpr std::array<SupportClassLook, kSupportClasses> kSupportLooks = {{
    {"seen by two or more images", {0, 114, 178}, 0.75f},
    {"seen by one image", {86, 180, 233}, 0.5f},
    {"proposed and trusted", {240, 228, 66}, 0.25f},
    {"weakly supported", {213, 94, 0}, 0},
}};

const SupportClassLook& LookOf(SupportClass support_class) { return kSupportLooks[static_cast<size_t>(support_class)]; }

}  // namespace

Gaussians Recolored(const Gaussians& gaussians, const Buffer<float>& colors) {
  gaussians.Check("Recolored");
  const int64_t n = gaussians.size();
  if (colors.count() != 3 * n) throw ShapeError("Recolored: {} for {} Gaussians", colors.shape().Text(), n);
  Buffer<float> sh = Buffer<float>::Zeros(gaussians.sh.shape());
  for (int64_t i = 0; i < n; ++i) {
    for (int64_t c = 0; c < 3; ++c)
      sh[kShFloats * i + c] = (colors[3 * i + c] - 0.5f) / static_cast<float>(kConstantSh);
  }
  Gaussians recolored = gaussians;
  recolored.sh = sh.To(gaussians.device());
  return recolored;
}

const char* NameOf(SupportClass support_class) { return LookOf(support_class).name; }

std::array<uint8_t, 3> ColorOf(SupportClass support_class) { return LookOf(support_class).color; }

SupportClass SupportClassOf(float support) {
  for (int k = 0; k + 1 < kSupportClasses; ++k) {
    if (support >= kSupportLooks[static_cast<size_t>(k)].from) return static_cast<SupportClass>(k);
  }
  return SupportClass::kWeak;
}

Buffer<float> SupportColors(std::span<const float> support) {
  Buffer<float> colors = Buffer<float>::Empty({static_cast<int64_t>(support.size()), 3});
  float* out = colors.data();
  for (const float value : support) {
    for (const uint8_t channel : ColorOf(SupportClassOf(value))) *out++ = static_cast<float>(channel) / 255;
  }
  return colors;
}

}  // namespace oraclegs
