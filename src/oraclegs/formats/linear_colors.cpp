#include "oraclegs/formats/linear_colors.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "oraclegs/core/parallel.h"
#include "oraclegs/core/unique_json.h"

namespace oraclegs {
namespace {

constexpr int64_t kColorGrain = 4096;  // Gaussians a task
constexpr float kMinSpread = 1e-3f;    // of a color over the directions; for a smaller one the slope would be noise

}  // namespace

float SrgbOfLinear(float linear) {
  return linear <= 0.0031308f ? 12.92f * linear : 1.055f * std::pow(linear, 1 / 2.4f) - 0.055f;
}

void ColorsFromLinear(int sh_degree, Gaussians* gaussians) {
  constexpr float kConstant = kConstantSh;
  const int coefficients = ShCount(sh_degree);
  const GaussianRows all = gaussians->Rows();
  ParallelBlocks(gaussians->size(), kColorGrain, [&](int64_t begin, int64_t end) {
    for (int64_t i = begin; i < end; ++i) {
      for (int c = 0; c < 3; ++c) {
        float* sh = all.From(i).sh + c;
        float squares = 0;
        for (int k = 1; k < coefficients; ++k) squares += sh[3 * k] * sh[3 * k];
        const float spread = std::sqrt(squares / (4 * std::numbers::pi_v<float>)), mean = 0.5f + kConstant * sh[0];
        const float step = std::max(spread, kMinSpread);
        const float low = SrgbOfLinear(mean - step), high = SrgbOfLinear(mean + step);
        sh[0] = ((spread > kMinSpread ? (low + high) / 2 : SrgbOfLinear(mean)) - 0.5f) / kConstant;
        for (int k = 1; k < coefficients; ++k) sh[3 * k] *= (high - low) / (2 * step);
      }
    }
  });
}

std::string LinearColorsConverted(const std::string& file) {
  return fmt::format(
      "{}: its colors are linear; they are converted to sRGB, which is not exact where Gaussians cover each other",
      file);
}

std::string UnknownColorSpace(const std::string& space, const std::string& known, const std::string& file) {
  return fmt::format("{}: its colors are in the space {}, which is not known; they are taken for {}", file,
                     QuotedForMessage(space), known);
}

}  // namespace oraclegs
