#include "oraclegs/formats/codecs.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <nlohmann/json.hpp>

#include "oraclegs/core/parallel.h"
#include "oraclegs/core/statistics.h"
#include "oraclegs/formats/gltf_layout.h"

namespace oraclegs {
namespace {

constexpr int kArrayBuffer = 34962;

void AppendChunk(uint32_t kind, std::string bytes, char padding, std::string* to) {
  bytes.resize((bytes.size() + 3) / 4 * 4, padding);
  char header[kGlbChunkHeader];
  StoreLittle(header, static_cast<uint32_t>(bytes.size()));
  StoreLittle(header + 4, kind);
  to->append(header, sizeof(header));
  to->append(bytes);
}

/// One mesh of one primitive, whose attributes are added one after the other.
class GltfWriter {
 public:
  explicit GltfWriter(const Gaussians& turned) : g_(turned), rows_(turned.Rows()) {
    json_ = {{"asset", {{"version", "2.0"}, {"generator", "oraclegs"}}},
             {"extensionsUsed", {kSplatExtension}},
             {"scene", 0},
             {"scenes", {{{"nodes", {0}}}}},
             {"nodes", {{{"mesh", 0}}}}};
    extension_ = {{"kernel", "ellipse"},
                  {"colorSpace", kDisplayColors},
                  {"sortingMethod", "cameraDistance"},
                  {"projection", "perspective"}};
  }

  /// An accessor of floats; `fill(i, to)` writes those of a Gaussian. Without bytes where the values come from SPZ.
  template <class F>
  void Add(const std::string& attribute, int components, bool stored, F&& fill) {
    const char* types[] = {"", "SCALAR", "", "VEC3", "VEC4"};
    nlohmann::json accessor = {{"componentType", kGltfFloat}, {"count", g_.size()}, {"type", types[components]}};
    if (stored) {
      accessor["bufferView"] = AddView(4 * components, [&](int64_t i, char* to) {
        float values[4];
        fill(i, values);
        std::memcpy(to, values, sizeof(float) * components);
      });
    }
    attributes_[attribute] = AddAccessor(std::move(accessor));
  }

  /// Position with its bounds, and every attribute of the extension.
  void AddGaussians(int degree, bool stored) {
    Add("POSITION", 3, stored, [&](int64_t i, float* to) { std::copy_n(rows_.From(i).means, 3, to); });
    AddBounds();
    Add(kSplatRotation, 4, stored, [&](int64_t i, float* to) {
      const std::array<float, 4> q = UnitQuaternion(rows_.From(i).quats);
      std::copy_n(q.data() + 1, 3, to);
      to[3] = q[0];
    });
    Add(kSplatScale, 3, stored, [&](int64_t i, float* to) {
      for (int c = 0; c < 3; ++c) to[c] = DeviationOf(rows_.From(i).log_scales[c]);
    });
    Add(kSplatOpacity, 1, stored, [&](int64_t i, float* to) { *to = Sigmoid(g_.opacity_logits[i]); });
    for (int k = 0; k < ShCount(degree); ++k) {
      Add(HarmonicAttribute(k), 3, stored, [&](int64_t i, float* to) { std::copy_n(rows_.From(i).sh + 3 * k, 3, to); });
    }
  }

  /// The color and opacity of the points that viewers without the extension show.
  void AddPointColors() {
    attributes_["COLOR_0"] =
        AddAccessor({{"componentType", kGltfUnsignedByte},
                     {"normalized", true},
                     {"count", g_.size()},
                     {"type", "VEC4"},
                     {"bufferView", AddView(4, [&](int64_t i, char* to) {
                        const GaussianRows g = rows_.From(i);
                        for (int c = 0; c < 3; ++c) {
                          to[c] =
                              static_cast<char>(NearestByte((g.sh[c] * static_cast<float>(kConstantSh) + 0.5f) * 255));
                        }
                        to[3] = static_cast<char>(NearestByte(Sigmoid(g.opacity_logits[0]) * 255));
                      })}});
  }

  void AddSpz(const std::string& spz) {
    views_.push_back({{"buffer", 0}, {"byteOffset", bin_.size()}, {"byteLength", spz.size()}});
    bin_ += spz;
    extension_["extensions"][kSpzExtension] = {{"bufferView", views_.size() - 1}};
    json_["extensionsUsed"].push_back(kSpzExtension);
    json_["extensionsRequired"] = {kSplatExtension, kSpzExtension};
  }

  std::string Write() {
    bin_.resize((bin_.size() + 3) / 4 * 4, '\0');
    json_["buffers"] = {{{"byteLength", bin_.size()}}};
    json_["bufferViews"] = views_;
    json_["accessors"] = accessors_;
    json_["meshes"] = {
        {{"primitives",
          {{{"attributes", attributes_}, {"mode", 0}, {"extensions", {{kSplatExtension, extension_}}}}}}}};
    std::string chunks;
    AppendChunk(kGlbJsonChunk, json_.dump(), ' ', &chunks);
    AppendChunk(kGlbBinChunk, std::move(bin_), '\0', &chunks);
    if (chunks.size() > std::numeric_limits<uint32_t>::max() - kGlbHeader) {
      throw RunError("{} Gaussians need more than the 4 GB of a .glb file; lower --max-gaussians or --sh-degree",
                     g_.size());
    }
    char header[kGlbHeader];
    StoreLittle(header, kGlbMagic);
    StoreLittle(header + 4, kGlbVersion);
    StoreLittle(header + 8, static_cast<uint32_t>(kGlbHeader + chunks.size()));
    return std::string(header, sizeof(header)) + chunks;
  }

 private:
  size_t AddAccessor(nlohmann::json accessor) {
    accessors_.push_back(std::move(accessor));
    return accessors_.size() - 1;
  }

  template <class F>
  size_t AddView(int stride, F&& fill) {
    const size_t begin = bin_.size(), length = static_cast<size_t>(g_.size()) * stride;
    bin_.resize(begin + length);
    ParallelBlocks(g_.size(), kSplatGrain, [&](int64_t first, int64_t end) {
      for (int64_t i = first; i < end; ++i) fill(i, bin_.data() + begin + i * stride);
    });
    views_.push_back({{"buffer", 0}, {"byteOffset", begin}, {"byteLength", length}, {"target", kArrayBuffer}});
    return views_.size() - 1;
  }

  void AddBounds() {
    std::array<float, 3> low, high;
    low.fill(INFINITY);
    high.fill(-INFINITY);
    for (int64_t i = 0; i < 3 * g_.size(); ++i) {
      low[i % 3] = std::min(low[i % 3], g_.means[i]);
      high[i % 3] = std::max(high[i % 3], g_.means[i]);
    }
    accessors_.back()["min"] = low;
    accessors_.back()["max"] = high;
  }

  const Gaussians& g_;
  const GaussianRows rows_;
  nlohmann::json json_, extension_, attributes_ = nlohmann::json::object();
  std::vector<nlohmann::json> accessors_, views_;
  std::string bin_;
};

Gaussians TurnedForGltf(const Gaussians& gaussians, int degree) {
  Gaussians turned = HostCopy(gaussians, degree);
  const GaussianRows all = turned.Rows();
  ParallelBlocks(turned.size(), kSplatGrain, [&](int64_t begin, int64_t end) {
    for (int64_t i = begin; i < end; ++i) TurnHalf(all.From(i), kTurnAboutZ);
  });
  return turned;
}

}  // namespace

std::string EncodeGltf(const Gaussians& gaussians, int sh_degree, const std::vector<float>& support) {
  gaussians.Check("EncodeGltf");
  const Gaussians turned = TurnedForGltf(gaussians, sh_degree);
  GltfWriter writer(turned);
  writer.AddGaussians(sh_degree, true);
  writer.AddPointColors();
  if (!support.empty()) writer.Add(kSplatSupport, 1, true, [&](int64_t i, float* to) { *to = support[i]; });
  return writer.Write();
}

std::string EncodeGltfSpz(const Gaussians& gaussians, int sh_degree) {
  gaussians.Check("EncodeGltfSpz");
  const Gaussians turned = TurnedForGltf(gaussians, sh_degree);
  GltfWriter writer(turned);
  writer.AddGaussians(sh_degree, false);
  // The extension has SPZ packed from glTF's axes to SPZ's own, which is where SPZ has them anyway.
  writer.AddSpz(EncodeSpz(gaussians, sh_degree, SpzVersion::k2));
  return writer.Write();
}

}  // namespace oraclegs
