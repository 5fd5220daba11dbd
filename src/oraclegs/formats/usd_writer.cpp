#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <limits>

#include "oraclegs/core/parallel.h"
#include "oraclegs/core/statistics.h"
#include "oraclegs/formats/codecs.h"
#include "oraclegs/formats/usd_layout.h"
#include "oraclegs/formats/zip_archive.h"

namespace oraclegs {
namespace {

constexpr int64_t kBlocksAtOnce = 64;   // of kSplatGrain Gaussians: their text stands in memory twice
constexpr size_t kMaxFloatDigits = 16;  // "-1.17549435e-38" has 15
constexpr size_t kUsualNumberBytes =
    14;                                // of a number of trained Gaussians and what separates it from the next, or less
constexpr size_t kUsdzAlignment = 64;  // of a file's bytes in a .usdz
constexpr float kDrawnDeviations = 3;

/// The shortest text that is read as the same float, which is what makes the file exact.
void AppendFloat(float value, std::string* to) {
  char digits[kMaxFloatDigits];
  to->append(digits, std::to_chars(digits, digits + sizeof(digits), value + 0.f).ptr);  // 0 for -0
}

/// A tuple; without parentheses where it is one number.
void AppendTuple(const float* values, int components, std::string* to) {
  if (components == 1) return AppendFloat(*values, to);
  for (int c = 0; c < components; ++c) {
    to->push_back(c == 0 ? '(' : ',');
    AppendFloat(values[c], to);
  }
  to->push_back(')');
}

class UsdaWriter {
 public:
  UsdaWriter(const Gaussians& turned, double meters_per_unit) : g_(turned), rows_(turned.Rows()) {
    text_ = fmt::format(
        "#usda 1.0\n(\n    customLayerData = {{\n        string creator = \"oraclegs\"\n    }}\n"
        "    defaultPrim = \"Splat\"\n    metersPerUnit = {}\n    upAxis = \"Y\"\n)\n\n"
        "def {} \"Splat\" (\n    prepend apiSchemas = [\"ColorSpaceAPI\"]\n)\n{{\n"
        "    uniform token {} = \"{}\"\n    uniform token projectionModeHint = \"perspective\"\n"
        "    uniform token sortingModeHint = \"zDepth\"\n",
        meters_per_unit, kUsdSplat, kUsdColorSpace, kUsdSrgb);
  }

  std::string Write(int degree) {
    text_.reserve(text_.size() + static_cast<size_t>(g_.size() * (11 + 3 * ShCount(degree))) * kUsualNumberBytes);
    AddExtent();
    Add("point3f[]", kUsdPositions, 3, 1, [&](int64_t i, float* to) { std::copy_n(rows_.From(i).means, 3, to); });
    Add("quatf[]", kUsdOrientations, 4, 1, [&](int64_t i, float* to) {
      std::copy_n(UnitQuaternion(rows_.From(i).quats).data(), 4, to);  // w first, as here
    });
    Add("float3[]", kUsdScales, 3, 1, [&](int64_t i, float* to) {
      for (int c = 0; c < 3; ++c) to[c] = DeviationOf(rows_.From(i).log_scales[c]);
    });
    Add("float[]", kUsdOpacities, 1, 1, [&](int64_t i, float* to) { *to = Sigmoid(g_.opacity_logits[i]); });
    text_ += fmt::format("    uniform int {} = {}\n", kUsdDegree, degree);
    const int coefficients = ShCount(degree);
    Add("float3[]", kUsdHarmonics, 3, coefficients,
        [&](int64_t i, float* to) { std::copy_n(rows_.From(i).sh, 3 * coefficients, to); });
    text_ += "}\n";
    return std::move(text_);
  }

 private:
  /// An array with a line for each Gaussian: `tuples` of so many components, which `fill(i, to)` writes.
  template <class F>
  void Add(const char* type, const char* name, int components, int tuples, F&& fill) {
    text_ += fmt::format("    {} {} = [\n", type, name);
    const int64_t blocks = (g_.size() + kSplatGrain - 1) / kSplatGrain;
    for (int64_t first = 0; first < blocks; first += kBlocksAtOnce) {
      std::vector<std::string> texts(static_cast<size_t>(std::min(kBlocksAtOnce, blocks - first)));
      ParallelFor(static_cast<int64_t>(texts.size()), [&](int64_t b) {
        const int64_t begin = (first + b) * kSplatGrain, end = std::min(begin + kSplatGrain, g_.size());
        std::array<float, kShFloats> values;
        for (int64_t i = begin; i < end; ++i) {
          fill(i, values.data());
          for (int t = 0; t < tuples; ++t) {
            AppendTuple(values.data() + t * components, components, &texts[b]);
            const bool is_last = i + 1 == g_.size() && t + 1 == tuples;
            if (!is_last) texts[b].push_back(',');
          }
          texts[b].push_back('\n');
        }
      });
      for (const std::string& text : texts) text_ += text;
    }
    text_ += "    ]\n";
  }

  /// The box of what is seen, from which viewers choose their first view.
  void AddExtent() {
    constexpr float kMax = std::numeric_limits<float>::max();
    std::array<float, 3> low, high;
    low.fill(kMax);
    high.fill(-kMax);
    for (int64_t i = 0; i < g_.size(); ++i) {
      const GaussianRows g = rows_.From(i);
      const float reach = kDrawnDeviations * DeviationOf(std::max({g.log_scales[0], g.log_scales[1], g.log_scales[2]}));
      for (int c = 0; c < 3; ++c) {
        low[c] = std::clamp(g.means[c] - reach, -kMax, low[c]);
        high[c] = std::clamp(g.means[c] + reach, high[c], kMax);
      }
    }
    text_ += "    float3[] extent = [";
    AppendTuple(low.data(), 3, &text_);
    text_ += ", ";
    AppendTuple(high.data(), 3, &text_);
    text_ += "]\n";
  }

  const Gaussians& g_;
  const GaussianRows rows_;
  std::string text_;
};

}  // namespace

std::string EncodeUsda(const Gaussians& gaussians, int sh_degree, double meters_per_unit) {
  gaussians.Check("EncodeUsda");
  const Gaussians turned = HostCopy(gaussians, sh_degree);
  const GaussianRows all = turned.Rows();
  ParallelBlocks(turned.size(), kSplatGrain, [&](int64_t begin, int64_t end) {
    for (int64_t i = begin; i < end; ++i) TurnHalf(all.From(i), kTurnAboutX);
  });
  return UsdaWriter(turned, meters_per_unit).Write(sh_degree);
}

std::string EncodeUsdz(const Gaussians& gaussians, int sh_degree, double meters_per_unit) {
  return WriteZip({{"splat.usda", EncodeUsda(gaussians, sh_degree, meters_per_unit)}}, kUsdzAlignment);
}

}  // namespace oraclegs
