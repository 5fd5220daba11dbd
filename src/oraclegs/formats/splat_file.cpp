#include "oraclegs/formats/splat_file.h"

#include <algorithm>
#include <cctype>
#include <cmath>
#include <limits>

#include "oraclegs/core/files.h"
#include "oraclegs/core/parallel.h"
#include "oraclegs/formats/codecs.h"
#include "oraclegs/formats/spatial_order.h"
#include "oraclegs/gaussians/selection.h"
#include "oraclegs/scene/frame_comments.h"

namespace oraclegs {
namespace {

namespace fs = std::filesystem;

constexpr int kMaxPasses = 4;      // writing again what a pass has lost
constexpr int64_t kLostOf = 1000;  // one Gaussian in so many may be left out of a file that cannot hold it
constexpr int64_t kCutOf = 10;     // from one in so many on, cut colors are a warning
constexpr const char* kSpz = ".spz";

/// A format that is not read, by the end of its name.
struct RefusedFormat {
  std::string_view end, what, way_out;
};

constexpr const char* kBySplatTransform = "convert it to .ply, for example with SuperSplat or splat-transform";
constexpr RefusedFormat kRefused[] = {
    {".ksplat", "the private format of one viewer", kBySplatTransform},
    {".lcc", "XGRIDS' format in several files", "convert it to .ply by `splat-transform scene.lcc scene.ply`"},
    {".lcc2", "XGRIDS' format in several files", "convert it to .ply by `splat-transform scene.lcc2 scene.ply`"},
    {".rad", "Spark's format of levels of detail", "take the file that it was made of"},
    {".usdc", "binary USD", "make a text of it by `usdcat --flatten scene.usdc -o scene.usda`"},
    {".usd", "USD that may be binary", "make a text of it by `usdcat --flatten scene.usd -o scene.usda`"},
    {".gltf", "glTF in several files", "let the program that made it write one .glb"},
};

constexpr float kAny = std::numeric_limits<float>::infinity();
constexpr SplatPromise kFloats{0, 1e-4f, 0, -kAny, kAny, 0, kAny};  // docs/formats.md has the same numbers
constexpr SplatPromise kSpzPromise{0.25f, 1 / 32.f, 0.0038f, -0.443f, 1.443f, 1 / 16.f, 1};
constexpr SplatPromise kChunkPromise{1, 0.02f, 0.034f, kLowestColor, kHighestColor, 1 / 64.f, kLargestHarmonic};
constexpr SplatPromise kSogPromise{0.25f, 0.7f, 0.25f, kLowestColor, kHighestColor, kAny, kLargestHarmonic};
constexpr SplatPromise kSplatPromise{0, 1e-4f, 1 / 510.f, 0, 1, 0, 0};

std::vector<std::string> CommentsOf(const GaussianPly& splat) {
  std::vector<std::string> comments = splat.comments;
  if (splat.antialiased && !SaysAntialiased(comments)) comments.emplace_back(kAntialiasedComment);
  return comments;
}

/// USD wants a number: 1 where the length of a unit is not known.
double MetersPerUnit(const GaussianPly& splat) {
  const std::optional<double> known = UnitMetersOf(splat.comments);
  return known ? *known : 1;
}

template <SpzVersion version>
std::string EncodeSpzOf(const GaussianPly& splat) {
  return EncodeSpz(splat.gaussians, splat.sh_degree, version, splat.antialiased);
}

/// A PLY of either kind, whatever its name ends with.
GaussianPly DecodeAnyPly(std::string_view bytes, const std::string& file) {
  return IsCompressedPly(ParsePlyHeader(bytes, file)) ? DecodeCompressedPly(bytes, file)
                                                      : DecodeGaussianPly(bytes, file);
}

std::string LowerName(const fs::path& path) {
  std::string name = path.filename().string();
  std::transform(name.begin(), name.end(), name.begin(), [](unsigned char c) { return std::tolower(c); });
  return name;
}

/// The format with the longest end that fits (.compressed.ply ends in .ply, too); null = none.
const SplatFormat* FindFormat(const fs::path& path, const std::vector<SplatFormat>& formats) {
  const std::string name = LowerName(path);
  const SplatFormat* found = nullptr;
  for (const SplatFormat& format : formats) {
    const bool fits = name.size() > format.extension.size() && name.ends_with(format.extension);
    if (fits && (!found || format.extension.size() > found->extension.size())) found = &format;
  }
  return found;
}

const RefusedFormat* FindRefused(const fs::path& path) {
  const std::string end = fs::path(LowerName(path)).extension().string();
  for (const RefusedFormat& format : kRefused) {
    if (end == format.end) return &format;
  }
  return nullptr;
}

GaussianPly ReadAny(const fs::path& path, const std::vector<SplatFormat>& formats) {
  if (IsSogFolder(path)) return ReadSogFolder(path);
  if (path.filename() == "meta.json" && IsSogFolder(path.parent_path())) return ReadSogFolder(path.parent_path());
  const SplatFormat& format = SplatFormatOf(path, formats);
  return format.decode(ReadFile(path), path.string());
}

std::vector<int64_t> FiniteRows(const Gaussians& gaussians) {
  std::vector<char> finite(static_cast<size_t>(gaussians.size()), 1);
  gaussians.ForEach([&](const char*, const Buffer<float>& part) {
    const int64_t row = part.shape().row();
    ParallelBlocks(gaussians.size(), kSplatGrain, [&](int64_t begin, int64_t end) {
      for (int64_t k = begin * row; k < end * row; ++k) {
        if (!std::isfinite(part[k])) finite[k / row] = 0;
      }
    });
  });
  std::vector<int64_t> rows;
  for (int64_t i = 0; i < gaussians.size(); ++i) {
    if (finite[i] != 0) rows.push_back(i);
  }
  return rows;
}

/// All of n but these, which ascend.
std::vector<int64_t> OthersThan(const std::vector<int64_t>& lost, int64_t n) {
  std::vector<int64_t> rows;
  auto next = lost.begin();
  for (int64_t i = 0; i < n; ++i) {
    if (next != lost.end() && *next == i) {
      ++next;
    } else {
      rows.push_back(i);
    }
  }
  return rows;
}

/// Some Gaussians of a splat, in this order, with all that it says of them.
GaussianPly PickedSplat(const GaussianPly& splat, const std::vector<int64_t>& rows) {
  GaussianPly picked = splat;
  picked.gaussians = Picked(splat.gaussians, rows);
  picked.marks = Picked(splat.marks, rows);
  return picked;
}

/// Reads the bytes as the program's own reader does. Throws InputError when it is not as many Gaussians.
Gaussians ReadBack(const SplatFormat& format, std::string_view bytes, const GaussianPly& given,
                   const std::string& file) {
  std::string why = "it would lack Gaussians";
  try {
    GaussianPly read = format.decode(bytes, file);
    if (read.gaussians.size() == given.gaussians.size() && read.sh_degree == given.sh_degree) return read.gaussians;
  } catch (const InputError& error) {
    why = error.what();
  }
  throw InputError("{}: could not be read again, so nothing was written: {}; take .ply or .glb", file, why);
}

}  // namespace

const std::vector<SplatFormat>& SplatFormats() {
  static const std::vector<SplatFormat> formats = {
      {.extension = ".ply",
       .promise = kFloats,
       .keeps_comments = true,
       .keeps_antialiased = true,
       .decode = DecodeAnyPly,
       .encode =
           [](const GaussianPly& s) { return EncodeGaussianPly(s.gaussians, s.sh_degree, CommentsOf(s), s.marks); }},
      {.extension = ".compressed.ply",
       .promise = kChunkPromise,
       .order = FileOrder::kByPlace,
       .keeps_comments = true,
       .keeps_antialiased = true,
       .decode = DecodeAnyPly,
       .encode = [](const GaussianPly& s) { return EncodeCompressedPly(s.gaussians, s.sh_degree, CommentsOf(s)); }},
      {.extension = kSpz,
       .promise = kSpzPromise,
       .order = FileOrder::kByPlace,
       .half_turn = kTurnAboutX,
       .keeps_antialiased = true,
       .decode = DecodeSpz,
       .encode = EncodeSpzOf<SpzVersion::k3>},
      {.extension = ".sog",
       .promise = kSogPromise,
       .order = FileOrder::kByPlace,
       .keeps_antialiased = true,
       .decode = DecodeSog,
       .encode =
           [](const GaussianPly& s) { return EncodeSog(s.gaussians, s.sh_degree, s.marks.support, s.antialiased); }},
      {.extension = ".splat",
       .promise = kSplatPromise,
       .max_sh_degree = 0,
       .decode = DecodeSplat,
       .encode = [](const GaussianPly& s) { return EncodeSplat(s.gaussians); }},
      {.extension = ".glb",
       .promise = kFloats,
       .half_turn = kTurnAboutZ,
       .decode = DecodeGltf,
       .encode = [](const GaussianPly& s) { return EncodeGltf(s.gaussians, s.sh_degree, s.marks.support); }},
      {.extension = ".spz.glb",
       .promise = kSpzPromise,
       .order = FileOrder::kByPlace,
       .half_turn = kTurnAboutZ,
       .decode = DecodeGltf,
       .encode = [](const GaussianPly& s) { return EncodeGltfSpz(s.gaussians, s.sh_degree); }},
      {.extension = ".usda",
       .promise = kFloats,
       .half_turn = kTurnAboutX,
       .decode = DecodeUsda,
       .encode = [](const GaussianPly& s) { return EncodeUsda(s.gaussians, s.sh_degree, MetersPerUnit(s)); }},
      {.extension = ".usdz",
       .promise = kFloats,
       .half_turn = kTurnAboutX,
       .decode = DecodeUsdz,
       .encode = [](const GaussianPly& s) { return EncodeUsdz(s.gaussians, s.sh_degree, MetersPerUnit(s)); }},
  };
  return formats;
}

std::vector<SplatFormat> WithSpz4(std::vector<SplatFormat> formats) {
  for (SplatFormat& format : formats) {
    if (format.extension == kSpz) format.encode = EncodeSpzOf<SpzVersion::k4>;
  }
  return formats;
}

std::string SplatExtensions(const std::vector<SplatFormat>& formats) {
  std::string text;
  for (const SplatFormat& format : formats) {
    text += (text.empty() ? "" : &format == &formats.back() ? " or " : ", ") + format.extension;
  }
  return text;
}

const SplatFormat& SplatFormatOf(const fs::path& path, const std::vector<SplatFormat>& formats) {
  if (const SplatFormat* format = FindFormat(path, formats)) return *format;
  if (const RefusedFormat* refused = FindRefused(path)) {
    throw UsageError("{}: {} is {}, which is neither read nor written; {}", path.string(), refused->end, refused->what,
                     refused->way_out);
  }
  throw UsageError("{}: is no known splat format; give a file name that ends in {}", path.string(),
                   SplatExtensions(formats));
}

bool IsSplatFolder(const fs::path& path) { return IsSogFolder(path); }

std::optional<std::string> SplatNameOf(const fs::path& path) {
  const std::string name = path.filename().string();
  if (const SplatFormat* format = FindFormat(path, SplatFormats())) {
    return name.substr(0, name.size() - format->extension.size());
  }
  if (FindRefused(path) != nullptr) return path.stem().string();
  return std::nullopt;
}

GaussianPly ReadSplat(const fs::path& path, const Listener& listener, const std::vector<SplatFormat>& formats) {
  GaussianPly splat = ReadAny(path, formats);
  for (const std::string& warning : splat.warnings) listener(Warning{warning});
  return splat;
}

int64_t WriteSplat(const fs::path& path, const GaussianPly& splat, const Listener& listener,
                   const std::vector<SplatFormat>& formats) {
  const SplatFormat& format = SplatFormatOf(path, formats);
  const std::string file = path.string();
  GaussianPly kept = splat;
  kept.gaussians.Check("WriteSplat");
  kept.sh_degree = std::min(kept.sh_degree, format.max_sh_degree);
  kept.gaussians = HostCopy(kept.gaussians, kept.sh_degree);
  const int64_t all = kept.gaussians.size();
  std::vector<int64_t> finite = FiniteRows(kept.gaussians);
  std::string why;
  if (static_cast<int64_t>(finite.size()) < all) why = "numbers of theirs are not finite";
  // Gaussians that a format cannot hold show when it is read back; the others are written once more.
  std::string bytes;
  PromiseCheck check;
  int passes = 0;
  for (std::vector<int64_t> rows = std::move(finite);; ++passes) {
    if (passes == kMaxPasses || (all - static_cast<int64_t>(rows.size())) * kLostOf > all) {
      throw InputError(
          "{}: {} of {} Gaussians are not kept by {} ({}); nothing was written: take .ply or .glb, change the size "
          "with "
          "--scale, or leave far ones out by --crop or --remove-outliers",
          file, all - static_cast<int64_t>(rows.size()), all, format.extension, why);
    }
    if (static_cast<int64_t>(rows.size()) < kept.gaussians.size()) kept = PickedSplat(kept, rows);
    if (format.order == FileOrder::kByPlace) kept = PickedSplat(kept, SpatialOrder(kept.gaussians));
    bytes = format.encode(kept);
    check = CheckPromise(kept.gaussians, ReadBack(format, bytes, kept, file), format.promise);
    if (check.lost.empty()) break;
    if (why.empty()) why = check.first;
    rows = OthersThan(check.lost, kept.gaussians.size());
  }
  const int64_t left = kept.gaussians.size();
  if (left < all) {
    listener(Warning{fmt::format("{}: {} of {} Gaussians are left out, because {} does not keep them ({})", file,
                                 all - left, all, format.extension, why)});
  }
  if (check.cut > 0) {
    const std::string text = fmt::format("{}: colors of {} of {} Gaussians reach beyond what {} holds and are cut",
                                         file, check.cut, left, format.extension);
    listener(check.cut * kCutOf > left ? Event(Warning{text}) : Event(Note{text}));
  }
  if (kept.antialiased && !format.keeps_antialiased) {
    listener(Warning{fmt::format("{}: {} cannot say that the model was trained antialiased; choose that in the viewer",
                                 file, format.extension)});
  }
  WriteFileAtomically(path, bytes);
  return left;
}

}  // namespace oraclegs
