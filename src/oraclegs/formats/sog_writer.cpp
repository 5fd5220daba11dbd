#include "oraclegs/formats/codecs.h"

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>

#include "oraclegs/core/parallel.h"
#include "oraclegs/core/statistics.h"
#include "oraclegs/formats/codebook.h"
#include "oraclegs/formats/sog_layout.h"
#include "oraclegs/formats/webp.h"
#include "oraclegs/formats/zip_archive.h"

namespace oraclegs {
namespace {

constexpr int kMostSets = 16384;     // of harmonics: more cost more bytes than they save error
constexpr int kGaussiansPerSet = 8;  // at least, or the sets are larger than what they replace
constexpr float kLargestSogLogScale = 20;

/// A codebook of values cut to a range: one value far out would leave no entries for all others.
std::vector<float> CodebookWithin(std::vector<float> values, float low, float high) {
  for (float& v : values) v = std::clamp(v, low, high);
  return MakeCodebook(values);
}

/// The images and the description of one file.
class SogWriter {
 public:
  SogWriter(const Gaussians& sorted, int degree, bool antialiased) : g_(sorted), rows_(sorted.Rows()), degree_(degree) {
    const auto n = static_cast<double>(g_.size());
    width_ = std::max(4, static_cast<int>(std::ceil(std::sqrt(n) / 4)) * 4);
    height_ = std::max(4, static_cast<int>(std::ceil(n / width_ / 4)) * 4);
    meta_ = {{"version", kSogVersion}, {"asset", {{"generator", "oraclegs"}}}, {"count", g_.size()}};
    if (antialiased) meta_[kSogModel] = kSogAntialiased;
  }

  std::string Write(const std::vector<float>& support) {
    AddMeans();
    AddScales();
    AddRotations();
    AddColors();
    if (degree_ > 0) AddHarmonics();
    if (!support.empty()) {
      Add("support", "support.webp", [&](int64_t i, uint8_t* p) {
        p[0] = p[1] = p[2] = PackSupport(support[i]);
        p[3] = 255;
      });
    }
    // The description first: a reader that streams knows what follows.
    files_.insert(files_.begin(), {"meta.json", meta_.dump()});
    return WriteZip(files_);
  }

 private:
  /// An image with a pixel for each Gaussian, named in a group of the description.
  template <class F>
  void Add(const char* group, const char* name, F&& fill) {
    ByteImage image{width_, height_, std::vector<uint8_t>(4 * size_t{1} * width_ * height_)};
    ParallelBlocks(g_.size(), kSplatGrain, [&](int64_t begin, int64_t end) {
      for (int64_t i = begin; i < end; ++i) fill(i, image.rgba.data() + 4 * i);
    });
    meta_[group]["files"].push_back(name);
    files_.emplace_back(name, EncodeWebp(image));
  }

  void AddMeans() {
    std::array<double, 3> low, high;
    low.fill(INFINITY);
    high.fill(-INFINITY);
    for (int64_t i = 0; i < 3 * g_.size(); ++i) {
      const double y = ToLogSpace(g_.means[i]);
      low[i % 3] = std::min(low[i % 3], y);
      high[i % 3] = std::max(high[i % 3], y);
    }
    meta_["means"] = {{"mins", low}, {"maxs", high}};
    const auto fixed = [&](int64_t i, int c) {
      const double range = high[c] - low[c];
      const double t = range > 0 ? (ToLogSpace(g_.means[3 * i + c]) - low[c]) / range : 0;
      return static_cast<uint32_t>(std::lround(std::clamp(t, 0., 1.) * 65535));
    };
    for (const int shift : {0, 8}) {
      Add("means", shift == 0 ? "means_l.webp" : "means_u.webp", [&](int64_t i, uint8_t* p) {
        for (int c = 0; c < 3; ++c) p[c] = static_cast<uint8_t>(fixed(i, c) >> shift);
        p[3] = 255;
      });
    }
  }

  void AddScales() {
    const std::span<float> all = g_.log_scales.span();
    const std::vector<float> codebook =
        CodebookWithin({all.begin(), all.end()}, -kLargestSogLogScale, kLargestSogLogScale);
    meta_["scales"]["codebook"] = codebook;
    Add("scales", "scales.webp", [&](int64_t i, uint8_t* p) {
      for (int c = 0; c < 3; ++c) p[c] = NearestEntry(codebook, g_.log_scales[3 * i + c]);
      p[3] = 255;
    });
  }

  void AddRotations() {
    Add("quats", "quats.webp", [&](int64_t i, uint8_t* p) {
      const SmallestThree rotation = DropLargest(UnitQuaternion(g_.quats.data() + 4 * i));
      for (int c = 0; c < 3; ++c) p[c] = NearestByte((rotation.others[c] * kSogSqrtHalf + 0.5f) * 255);
      p[3] = static_cast<uint8_t>(kSogFirstRotationTag + rotation.largest);
    });
  }

  void AddColors() {
    std::vector<float> all;
    for (int64_t i = 0; i < g_.size(); ++i) {
      const float* sh = rows_.From(i).sh;
      all.insert(all.end(), sh, sh + 3);
    }
    constexpr float kConstant = kConstantSh;
    const std::vector<float> codebook =
        CodebookWithin(std::move(all), (kLowestColor - 0.5f) / kConstant, (kHighestColor - 0.5f) / kConstant);
    meta_["sh0"]["codebook"] = codebook;
    Add("sh0", "sh0.webp", [&](int64_t i, uint8_t* p) {
      const GaussianRows g = rows_.From(i);
      for (int c = 0; c < 3; ++c) p[c] = NearestEntry(codebook, g.sh[c]);
      p[3] = NearestByte(Sigmoid(g.opacity_logits[0]) * 255);
    });
  }

  void AddHarmonics() {
    const int coefficients = ShCount(degree_) - 1;
    const int64_t dims = 3 * coefficients;
    const Buffer<float> vectors = Buffer<float>::Empty({g_.size(), dims});
    std::vector<float> weights;
    for (int64_t i = 0; i < g_.size(); ++i) {
      const float* sh = rows_.From(i).sh + 3;
      std::transform(sh, sh + dims, vectors.data() + i * dims,
                     [](float x) { return std::clamp(x, -kLargestHarmonic, kLargestHarmonic); });
      weights.push_back(Sigmoid(g_.opacity_logits[i]));
    }
    const auto size = static_cast<int>(std::clamp<int64_t>(g_.size() / kGaussiansPerSet, 1, kMostSets));
    const Palette palette = MakePalette(vectors, weights, size);
    const std::span<float> colors = palette.colors.span();
    const std::vector<float> codebook = MakeCodebook({colors.begin(), colors.end()});
    const int64_t sets = palette.colors.size(0);
    meta_["shN"] = {{"count", sets}, {"bands", degree_}, {"codebook", codebook}};

    const auto rows = static_cast<int>((sets + kSogPaletteColumns - 1) / kSogPaletteColumns);
    ByteImage image{kSogPaletteColumns * coefficients, rows, {}};
    image.rgba.resize(4 * size_t{1} * image.width * image.height);
    // A row of the image holds 64 sets of `coefficients` pixels: sets follow each other without gaps.
    for (int64_t p = 0; p < sets * coefficients; ++p) {
      for (int c = 0; c < 3; ++c) image.rgba[4 * p + c] = NearestEntry(codebook, colors[3 * p + c]);
      image.rgba[4 * p + 3] = 255;
    }
    meta_["shN"]["files"].push_back("shN_centroids.webp");
    files_.emplace_back("shN_centroids.webp", EncodeWebp(image));
    Add("shN", "shN_labels.webp", [&](int64_t i, uint8_t* p) {
      p[0] = static_cast<uint8_t>(palette.labels[i]);
      p[1] = static_cast<uint8_t>(palette.labels[i] >> 8);
      p[3] = 255;
    });
  }

  const Gaussians g_;
  const GaussianRows rows_;
  const int degree_;
  int width_, height_;
  nlohmann::json meta_;
  std::vector<std::pair<std::string, std::string>> files_;
};

}  // namespace

std::string EncodeSog(const Gaussians& gaussians, int sh_degree, const std::vector<float>& support, bool antialiased) {
  gaussians.Check("EncodeSog");
  return SogWriter(gaussians.To(kCpu), sh_degree, antialiased).Write(support);
}

}  // namespace oraclegs
