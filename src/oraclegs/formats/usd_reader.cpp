#include <algorithm>
#include <cmath>
#include <map>
#include <set>

#include "oraclegs/core/parallel.h"
#include "oraclegs/core/unique_json.h"
#include "oraclegs/formats/codecs.h"
#include "oraclegs/formats/linear_colors.h"
#include "oraclegs/formats/splat_parts.h"
#include "oraclegs/formats/usd_layout.h"
#include "oraclegs/formats/usd_transform.h"
#include "oraclegs/formats/usda_text.h"
#include "oraclegs/formats/zip_archive.h"
#include "oraclegs/gaussians/transform.h"
#include "oraclegs/scene/frame_comments.h"

namespace oraclegs {
namespace {

constexpr size_t kMaxPrims = 100000;  // each takes many times the bytes of its text
constexpr int64_t kMaxUsdzFiles = 256;
constexpr int kHighestUsdDegree = 10;
/// Metadata that brings in other prims, most often of other files.
constexpr std::string_view kArcs[] = {"references",  "payload",  "subLayers",   "inherits",
                                      "specializes", "variants", "variantSets", "clips"};

[[noreturn]] void RefuseUsdArc(const std::string& file, std::string_view name) {
  throw InputError(
      "{}: has {}, which bring in prims from elsewhere and are not read; write it as one file with usdcat --flatten",
      file, name);
}

struct UsdAttribute {
  const char* name;  ///< in halves: with an h behind it
  int components;
};
constexpr UsdAttribute kAttributes[] = {
    {kUsdPositions, 3}, {kUsdOrientations, 4}, {kUsdScales, 3}, {kUsdOpacities, 1}, {kUsdHarmonics, 3}};

/// The attribute of Gaussians of this name, in floats or in halves; null for another.
const UsdAttribute* FindUsdAttribute(std::string_view name) {
  for (const UsdAttribute& attribute : kAttributes) {
    const std::string_view known = attribute.name;
    if (name == known || (name.size() == known.size() + 1 && name.ends_with('h') && name.starts_with(known))) {
      return &attribute;
    }
  }
  return nullptr;
}

struct UsdPrim {
  int parent = -1;
  bool is_splat = false;
  std::string name, color_space;
  UsdTransform transform;
  float degree = 3;  ///< of the schema where the prim says nothing
  std::map<std::string, std::vector<float>, std::less<>> numbers;
};

class UsdReader {
 public:
  UsdReader(std::string_view text, const std::string& file) : text_(text, file) {
    if (text_.Take('(')) ReadMetadata(nullptr);
    while (!text_.AtEnd()) {
      if (open_.empty() || !text_.Take('}')) {
        ReadStatement();
      } else {
        open_.pop_back();
      }
    }
    if (!open_.empty()) text_.Fail(fmt::format("the text ends within prim {}", Shown(prims_[open_.back()].name)));
  }

  GaussianPly Read() {
    const std::vector<Eigen::Matrix4d> places = Places();
    const std::vector<std::string> spaces = ColorSpaces();
    std::vector<SplatPart> parts;
    for (size_t i = 0; i < prims_.size(); ++i) {
      if (!prims_[i].is_splat) continue;
      SplatPart part = PartOf(prims_[i]);
      ConvertUsdColors(spaces[i], &part);
      if (!places[i].isIdentity(0)) {
        const std::optional<Similarity> place = EvenSimilarity(places[i]);
        if (!place) FailAt(prims_[i], "mirrors its Gaussians or scales them unevenly, which is not read");
        part.gaussians = Transformed(part.gaussians, *place);
      }
      parts.push_back(std::move(part));
    }
    if (parts.empty()) throw InputError("{}: has no prim of the type {}", text_.file(), kUsdSplat);
    GaussianPly splat = JoinedParts(parts, kTurnAboutX, text_.file());
    splat.warnings.assign(warnings_.begin(), warnings_.end());
    if (meters_per_unit_ != 1) splat.comments = WithUnit({}, meters_per_unit_);
    return splat;
  }

 private:
  static std::string Shown(std::string_view name) { return QuotedForMessage(std::string(name)); }

  [[noreturn]] void FailAt(const UsdPrim& prim, const std::string& what) const {
    throw InputError("{}: prim {} {}; export it again", text_.file(), Shown(prim.name), what);
  }

  /// Reads what stands in parentheses behind a prim, or at the top of the file; false where it makes the prim inactive.
  bool ReadMetadata(const UsdPrim* prim) {
    bool active = true;
    while (!text_.Take(')')) {
      if (text_.AtEnd()) text_.Fail("the text ends within metadata");
      if (!text_.WordFollows()) {
        text_.SkipValue();  // a text alone is a comment
        continue;
      }
      std::string_view key = text_.Word();
      while (text_.WordFollows()) key = text_.Word();  // "prepend references"
      if (!text_.TakeOnLine('=')) continue;
      const bool is_arc = std::find(std::begin(kArcs), std::end(kArcs), key) != std::end(kArcs);
      if (is_arc && !IsNothing()) RefuseUsdArc(text_.file(), key);
      if (is_arc) continue;
      if (prim == nullptr && key == "upAxis") {
        up_axis_ = text_.Quoted();
      } else if (prim == nullptr && key == "metersPerUnit") {
        meters_per_unit_ = ReadNumber(key);
      } else if (prim != nullptr && key == "active") {
        active = !IsNo(text_.Word());
      } else {
        text_.SkipValue();
      }
    }
    if (up_axis_ != "Y" && up_axis_ != "Z") text_.Fail(fmt::format("upAxis is {}, expected Y or Z", Shown(up_axis_)));
    if (!(meters_per_unit_ > 0) || !std::isfinite(meters_per_unit_)) {
      text_.Fail(fmt::format("metersPerUnit is {}, expected a number above 0", meters_per_unit_));
    }
    return active;
  }

  double ReadNumber(std::string_view name) {
    const std::vector<double> numbers = text_.Numbers<double>(1);
    if (numbers.size() != 1) text_.Fail(fmt::format("{} is no number", name));
    return numbers[0];
  }

  static bool IsNo(std::string_view word) { return word == "false" || word == "False" || word == "0"; }

  /// Passes a value of nothing: None, or an empty list; false, and stays in front of it, for any other.
  bool IsNothing() {
    if (text_.WordFollows()) return text_.Word() == "None";
    return text_.Take('[') && text_.Take(']');
  }

  void ReadStatement() {
    if (text_.Take('(')) text_.Fail("metadata stands behind nothing");
    const std::string_view word = text_.Word();
    if (word == "def" || word == "over" || word == "class") {
      ReadPrim(word == "def");
    } else if (word == "variantSet") {
      RefuseUsdArc(text_.file(), "variant sets");
    } else {
      ReadProperty(word);
    }
  }

  void ReadPrim(bool defined) {
    UsdPrim prim;
    if (text_.WordFollows()) prim.is_splat = text_.Word() == kUsdSplat;
    prim.name = text_.Quoted();
    if (text_.Take('(') && !ReadMetadata(&prim)) defined = false;
    if (!defined) {  // it is drawn nowhere
      text_.SkipValue();
      return;
    }
    if (!text_.Take('{')) text_.Fail(fmt::format("prim {} has no body", Shown(prim.name)));
    if (prims_.size() == kMaxPrims) text_.Fail(fmt::format("has more than {} prims: is it a splat?", kMaxPrims));
    if (!open_.empty()) prim.parent = open_.back();
    open_.push_back(static_cast<int>(prims_.size()));
    prims_.push_back(std::move(prim));
  }

  void ReadProperty(std::string_view first) {
    std::string_view type, name = first;
    while (text_.WordFollows()) {
      type = name;
      name = text_.Word();
    }
    if (text_.TakeOnLine('=')) {
      if (open_.empty()) {
        text_.SkipValue();
      } else {
        ReadValue(type, name, &prims_[open_.back()]);
      }
    }
    while (text_.Take('(')) SkipParentheses();
  }

  void SkipParentheses() {
    while (!text_.Take(')')) {
      if (text_.AtEnd()) text_.Fail("the text ends within metadata");
      if (!text_.Take('=') && !text_.Take(',')) text_.SkipValue();
    }
  }

  void ReadValue(std::string_view type, std::string_view name, UsdPrim* prim) {
    const std::string_view base = name.substr(0, name.find('.')), behind = name.substr(base.size());
    const UsdAttribute* attribute = prim->is_splat ? FindUsdAttribute(base) : nullptr;
    const bool is_degree = prim->is_splat && base == kUsdDegree;
    if ((attribute != nullptr || is_degree || UsdTransform::IsPart(base)) && !behind.empty()) {
      text_.Fail(fmt::format("{} moves in time or is connected, which is not read", Shown(name)));
    }
    if (attribute != nullptr) {
      if (!prim->numbers.emplace(base, text_.Numbers<float>(attribute->components)).second) {
        text_.Fail(fmt::format("{} stands there twice", Shown(name)));
      }
    } else if (is_degree) {
      prim->degree = static_cast<float>(ReadNumber(name));
    } else if (UsdTransform::IsPart(base)) {
      prim->transform.Read(type, base, &text_);
    } else if (name == kUsdColorSpace) {
      prim->color_space = text_.Quoted();
    } else {
      text_.SkipValue();
    }
  }

  /// The numbers of an attribute: floats where there are any, else halves.
  const std::vector<float>& NumbersOf(const UsdPrim& prim, const UsdAttribute& attribute) const {
    const std::string name = attribute.name;
    auto found = prim.numbers.find(name);
    if (found == prim.numbers.end()) found = prim.numbers.find(name + "h");
    if (found == prim.numbers.end()) FailAt(prim, fmt::format("has no {}", name));
    return found->second;
  }

  SplatPart PartOf(const UsdPrim& prim) {
    const std::vector<float>&means = NumbersOf(prim, kAttributes[0]), &rotations = NumbersOf(prim, kAttributes[1]),
          &scales = NumbersOf(prim, kAttributes[2]), &opacities = NumbersOf(prim, kAttributes[3]),
          &harmonics = NumbersOf(prim, kAttributes[4]);
    const auto n = static_cast<int64_t>(means.size() / 3);
    if (!(prim.degree >= 0 && prim.degree <= kHighestUsdDegree) || prim.degree != std::floor(prim.degree)) {
      FailAt(prim, fmt::format("has {} = {}, expected 0 to 3", kUsdDegree, prim.degree));
    }
    const auto degree = static_cast<int>(prim.degree);
    const int64_t coefficients = int64_t{degree + 1} * (degree + 1);
    const auto require = [&](const std::vector<float>& numbers, int64_t wanted, const char* name) {
      if (static_cast<int64_t>(numbers.size()) == wanted * n) return;
      FailAt(prim,
             fmt::format("has {} numbers of {} for {} Gaussians, expected {}", numbers.size(), name, n, wanted * n));
    };
    require(rotations, 4, kUsdOrientations);
    require(scales, 3, kUsdScales);
    require(opacities, 1, kUsdOpacities);
    require(harmonics, 3 * coefficients, kUsdHarmonics);
    SplatPart part{ZeroSplat(n, 0, text_.file()).gaussians, std::min(degree, kMaxShDegree)};
    if (degree > kMaxShDegree) warnings_.insert(DegreeLeftOut(degree, text_.file()));
    const GaussianRows rows = part.gaussians.Rows();
    ParallelBlocks(n, kSplatGrain, [&](int64_t begin, int64_t end) {
      for (int64_t i = begin; i < end; ++i) {
        const GaussianRows g = rows.From(i);
        std::copy_n(means.data() + 3 * i, 3, g.means);
        std::copy_n(rotations.data() + 4 * i, 4, g.quats);
        for (int c = 0; c < 3; ++c) g.log_scales[c] = LogOfDeviation(scales[3 * i + c]);
        g.opacity_logits[0] = LogitOfOpacity(opacities[i]);
        std::copy_n(harmonics.data() + 3 * coefficients * i, 3 * ShCount(part.degree), g.sh);
      }
    });
    return part;
  }

  /// The transforms of prims to the axes that positions have in the end: y up.
  std::vector<Eigen::Matrix4d> Places() const {
    Eigen::Matrix4d stage = Eigen::Matrix4d::Identity();
    if (up_axis_ == "Z") stage.topLeftCorner<3, 3>() << 1, 0, 0, 0, 0, 1, 0, -1, 0;
    std::vector<Eigen::Matrix4d> places;
    for (const UsdPrim& prim : prims_) {
      const bool at_top = prim.parent < 0 || prim.transform.ResetsStack();
      places.push_back((at_top ? stage : places[prim.parent]) * prim.transform.Matrix(text_.file()));
    }
    return places;
  }

  /// The color spaces of prims, each its own or that of the prims above it; empty where none says.
  std::vector<std::string> ColorSpaces() const {
    std::vector<std::string> spaces;
    for (const UsdPrim& prim : prims_) {
      spaces.push_back(!prim.color_space.empty() || prim.parent < 0 ? prim.color_space : spaces[prim.parent]);
    }
    return spaces;
  }

  void ConvertUsdColors(const std::string& space, SplatPart* part) {
    if (space.empty() || space.starts_with("srgb_rec709") || space == "srgb_texture") return;
    if (space.starts_with("lin_rec709")) {
      warnings_.insert(LinearColorsConverted(text_.file()));
      ColorsFromLinear(part->degree, &part->gaussians);
      return;
    }
    warnings_.insert(UnknownColorSpace(space, kUsdSrgb, text_.file()));
  }

  UsdaText text_;
  std::string up_axis_ = "Y";
  double meters_per_unit_ = 1;
  std::vector<UsdPrim> prims_;  // parents stand before their children
  std::vector<int> open_;       // prims whose bodies have not ended
  std::set<std::string> warnings_;
};

}  // namespace

GaussianPly DecodeUsda(std::string_view bytes, const std::string& file) {
  return WithoutDamaged(UsdReader(bytes, file).Read(), file);
}

GaussianPly DecodeUsdz(std::string_view bytes, const std::string& file) {
  const std::string* layer = nullptr;
  const std::map<std::string, std::string> files = ReadZip(bytes, kMaxUsdzFiles, file);
  for (const auto& [name, content] : files) {
    if (!name.ends_with(".usda") && !name.ends_with(".usdc") && !name.ends_with(".usd")) continue;
    if (layer != nullptr) RefuseUsdArc(file, "several layers");
    layer = &content;
  }
  if (layer == nullptr) throw InputError("{}: holds no file of USD (.usda); export it again", file);
  return DecodeUsda(*layer, file);
}

}  // namespace oraclegs
