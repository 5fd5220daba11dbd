#include "oraclegs/formats/codecs.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <memory>
#include <set>

#include "oraclegs/core/parallel.h"
#include "oraclegs/core/unique_json.h"
#include "oraclegs/formats/glb_file.h"
#include "oraclegs/formats/gltf_layout.h"
#include "oraclegs/formats/linear_colors.h"
#include "oraclegs/formats/splat_parts.h"
#include "oraclegs/gaussians/transform.h"

namespace oraclegs {
namespace {

// Primitives may share their bytes, so that a small file could promise any number of Gaussians. Attributes take 14
// bytes a Gaussian or more; SPZ is bounded as DecodeSpz bounds it.
constexpr int64_t kPlausibleRows = 1 << 16, kLeastBytesPerRow = 8;
constexpr int64_t kPlausiblePacked = 1 << 18, kMostPackedPerByte = 16;

/// Walks the nodes and collects the Gaussians in glTF's axes.
class GltfReader {
 public:
  /// `bytes`: of the whole file.
  GltfReader(const GlbFile& glb, size_t bytes)
      : glb_(glb),
        visited_(LengthOf("nodes")),
        meshes_(LengthOf("meshes"), Mesh::kUnseen),
        most_rows_(std::max(kPlausibleRows, static_cast<int64_t>(bytes) / kLeastBytesPerRow)),
        most_packed_(std::max(kPlausiblePacked, static_cast<int64_t>(bytes) * kMostPackedPerByte)) {
    const nlohmann::json& scene = glb.Item("scenes", glb.Integer(glb.json(), "scene", 0));
    // A list of what is left, not recursion: a file may be a chain of a million nodes.
    Push(scene, "nodes", Eigen::Matrix4d::Identity());
    while (!left_.empty()) {
      const auto [index, parent] = left_.back();
      left_.pop_back();
      Visit(index, *parent);
    }
  }

  std::vector<SplatPart> Take() { return std::move(splats_); }
  const std::set<std::string>& warnings() const { return warnings_; }

 private:
  enum class Mesh : uint8_t { kUnseen, kOther, kOfGaussians };

  size_t LengthOf(const char* list) const {
    const auto found = glb_.json().find(list);
    return found != glb_.json().end() && found->is_array() ? found->size() : 0;
  }

  [[noreturn]] void Fail(const std::string& what) const {
    throw InputError("{}: {}; export it again", glb_.file(), what);
  }

  /// Adds the nodes under a key to what is left, each once; they share their parent's matrix.
  void Push(const nlohmann::json& from, const char* key, const Eigen::Matrix4d& parent) {
    const auto children = from.find(key);
    if (children == from.end() || !children->is_array() || children->empty()) return;
    const auto matrix = std::make_shared<const Eigen::Matrix4d>(parent);
    for (const nlohmann::json& child : *children) {
      if (!child.is_number_unsigned()) Fail("a node is named by no number");
      const auto index = child.get<int64_t>();
      glb_.Item("nodes", index);
      if (visited_[index]) Fail(fmt::format("node {} stands at two places", index));
      visited_[index] = true;
      left_.emplace_back(index, matrix);
    }
  }

  void Visit(int64_t index, const Eigen::Matrix4d& parent) {
    const nlohmann::json& node = glb_.Item("nodes", index);
    const Eigen::Matrix4d here = parent * LocalMatrix(node);
    Push(node, "children", here);
    if (node.contains("mesh")) VisitMesh(glb_.Integer(node, "mesh", -1), here);
  }

  /// Looks at each mesh once, however many nodes name it.
  void VisitMesh(int64_t index, const Eigen::Matrix4d& here) {
    const nlohmann::json& mesh = glb_.Item("meshes", index);
    if (meshes_[index] == Mesh::kOfGaussians) {
      Fail(fmt::format("mesh {} of Gaussians stands at two nodes, which is not read", index));
    }
    if (meshes_[index] == Mesh::kOther) return;
    meshes_[index] = Mesh::kOther;
    const auto primitives = mesh.find("primitives");
    if (primitives == mesh.end() || !primitives->is_array()) return;
    for (const nlohmann::json& primitive : *primitives) {
      const nlohmann::json none = nlohmann::json::object();
      const nlohmann::json extensions = primitive.is_object() ? primitive.value("extensions", none) : none;
      if (extensions.is_object() && extensions.contains(kSplatExtension)) {
        meshes_[index] = Mesh::kOfGaussians;
        AddPrimitive(primitive, extensions[kSplatExtension], here);
      }
    }
  }

  /// Adds to a number of Gaussians so far.
  void Count(int64_t* so_far, int64_t n, int64_t most) const {
    *so_far += n;
    if (*so_far > most) Fail(fmt::format("has {} Gaussians or more, which its bytes cannot hold", *so_far));
  }

  /// `count` numbers under a key, or these where it is absent.
  std::vector<double> Numbers(const nlohmann::json& node, const char* key, std::vector<double> absent) const {
    if (!node.contains(key)) return absent;
    const nlohmann::json& list = node[key];
    if (!list.is_array() || list.size() != absent.size())
      Fail(fmt::format("'{}' of a node is not {} numbers", key, absent.size()));
    for (size_t i = 0; i < absent.size(); ++i) {
      if (!list[i].is_number()) Fail(fmt::format("'{}' of a node is not {} numbers", key, absent.size()));
      absent[i] = list[i].get<double>();
    }
    return absent;
  }

  Eigen::Matrix4d LocalMatrix(const nlohmann::json& node) const {
    if (node.contains("matrix")) {
      const std::vector<double> m = Numbers(node, "matrix", std::vector<double>(16));
      return Eigen::Map<const Eigen::Matrix4d>(m.data());
    }
    const std::vector<double> t = Numbers(node, "translation", {0, 0, 0}), r = Numbers(node, "rotation", {0, 0, 0, 1}),
                              s = Numbers(node, "scale", {1, 1, 1});
    Eigen::Affine3d local = Eigen::Affine3d::Identity();
    local.translate(Eigen::Vector3d(t[0], t[1], t[2]));
    local.rotate(Eigen::Quaterniond(r[3], r[0], r[1], r[2]).normalized());
    local.scale(Eigen::Vector3d(s[0], s[1], s[2]));
    return local.matrix();
  }

  void AddPrimitive(const nlohmann::json& primitive, const nlohmann::json& extension, const Eigen::Matrix4d& matrix) {
    const nlohmann::json none = nlohmann::json::object();
    const nlohmann::json inner = extension.is_object() ? extension.value("extensions", none) : none;
    const nlohmann::json spz = inner.is_object() ? inner.value(kSpzExtension, none) : none;
    SplatPart node = spz.is_object() && spz.contains("bufferView")
                         ? FromSpz(glb_.Integer(spz, "bufferView", -1))
                         : FromAttributes(primitive.value("attributes", none));
    ConvertColors(extension, &node);
    if (!matrix.isIdentity(0)) {
      const std::optional<Similarity> place = EvenSimilarity(matrix);
      if (!place) Fail("a node mirrors its Gaussians or scales them unevenly, which is not read");
      node.gaussians = Transformed(node.gaussians, *place);
    }
    splats_.push_back(std::move(node));
  }

  /// Brings colors that are stored as linear light to the program's.
  void ConvertColors(const nlohmann::json& extension, SplatPart* node) {
    const nlohmann::json space =
        extension.is_object() ? extension.value("colorSpace", nlohmann::json()) : nlohmann::json();
    if (space.is_null() || space == kDisplayColors) return;
    if (space == kLinearColors) {
      warnings_.insert(LinearColorsConverted(glb_.file()));
      ColorsFromLinear(node->degree, &node->gaussians);
      return;
    }
    warnings_.insert(
        UnknownColorSpace(space.is_string() ? space.get<std::string>() : space.dump(), kDisplayColors, glb_.file()));
  }

  SplatPart FromSpz(int64_t view) {
    GaussianPly splat = DecodeSpz(glb_.View(view), glb_.file());
    warnings_.insert(splat.warnings.begin(), splat.warnings.end());
    Count(&packed_, splat.gaussians.size(), most_packed_);
    for (int64_t i = 0; i < splat.gaussians.size(); ++i) TurnHalf(splat.gaussians.Rows().From(i), kTurnAboutZ);
    return {splat.gaussians, splat.sh_degree, {}};
  }

  SplatPart FromAttributes(const nlohmann::json& attributes) {
    if (!attributes.is_object()) Fail("a primitive has no attributes");
    const auto accessor = [&](const std::string& name) { return glb_.Integer(attributes, name.c_str(), -1); };
    for (const char* name : {"POSITION", kSplatRotation, kSplatScale, kSplatOpacity}) {
      if (accessor(name) < 0) Fail(fmt::format("its Gaussians have no attribute {}", name));
    }
    const int64_t n = glb_.Count(accessor("POSITION"));
    Count(&rows_, n, most_rows_);
    int degree = 0;
    while (degree < kMaxShDegree && accessor(HarmonicAttribute(ShCount(degree))) >= 0) ++degree;
    if (degree == kMaxShDegree && accessor(HarmonicAttribute(kShCoefficients)) >= 0) {
      warnings_.insert(DegreeLeftOut(degree + 1, glb_.file()));
    }
    SplatPart node{ZeroSplat(n, degree, glb_.file()).gaussians, degree, {}};
    const auto floats = [&](const std::string& name, int components) {
      std::vector<float> values = glb_.Floats(accessor(name), components);
      if (static_cast<int64_t>(values.size()) != n * components)
        Fail(fmt::format("{} is not of {} Gaussians", name, n));
      return values;
    };
    const std::vector<float> means = floats("POSITION", 3), rotations = floats(kSplatRotation, 4),
                             scales = floats(kSplatScale, 3), opacities = floats(kSplatOpacity, 1);
    const GaussianRows all = node.gaussians.Rows();
    for (int64_t i = 0; i < n; ++i) {
      const GaussianRows g = all.From(i);
      g.quats[0] = rotations[4 * i + 3];
      for (int c = 0; c < 3; ++c) {
        g.means[c] = means[3 * i + c];
        g.quats[1 + c] = rotations[4 * i + c];
        g.log_scales[c] = LogOfDeviation(scales[3 * i + c]);
      }
      g.opacity_logits[0] = LogitOfOpacity(opacities[i]);
    }
    for (int k = 0; k < ShCount(degree); ++k) {
      if (accessor(HarmonicAttribute(k)) < 0)
        Fail(fmt::format("its Gaussians have no attribute {}", HarmonicAttribute(k)));
      const std::vector<float> sh = floats(HarmonicAttribute(k), 3);
      for (int64_t i = 0; i < n; ++i) std::copy_n(sh.data() + 3 * i, 3, all.From(i).sh + 3 * k);
    }
    if (accessor(kSplatSupport) >= 0) node.support = floats(kSplatSupport, 1);
    for (const float s : node.support) {
      if (!(s >= 0 && s <= 1)) Fail(fmt::format("{} has {}, expected 0 to 1", kSplatSupport, s));
    }
    return node;
  }

  const GlbFile& glb_;
  std::vector<bool> visited_;  // nodes
  std::vector<Mesh> meshes_;
  int64_t rows_ = 0, packed_ = 0;  // Gaussians so far, of attributes and of SPZ
  int64_t most_rows_, most_packed_;
  std::vector<std::pair<int64_t, std::shared_ptr<const Eigen::Matrix4d>>> left_;
  std::vector<SplatPart> splats_;
  std::set<std::string> warnings_;
};

}  // namespace

GaussianPly DecodeGltf(std::string_view bytes, const std::string& file) {
  const GlbFile glb(bytes, file);
  GltfReader reader(glb, bytes.size());
  const std::vector<SplatPart> splats = reader.Take();
  if (splats.empty()) throw InputError("{}: no node of its scene has Gaussians ({})", file, kSplatExtension);
  GaussianPly splat = JoinedParts(splats, kTurnAboutZ, file);
  splat.warnings.assign(reader.warnings().begin(), reader.warnings().end());
  return WithoutDamaged(std::move(splat), file);
}

}  // namespace oraclegs
