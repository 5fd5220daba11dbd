#include "oraclegs/formats/splat_file.h"

#include <algorithm>
#include <cctype>
#include <cmath>
#include <limits>

#include "oraclegs/core/files.h"
#include "oraclegs/core/mapped_file.h"
#include "oraclegs/core/parallel.h"
#include "oraclegs/formats/compressed_ply.h"
#include "oraclegs/formats/gltf_reader.h"
#include "oraclegs/formats/gltf_writer.h"
#include "oraclegs/formats/promise.h"
#include "oraclegs/formats/sog_reader.h"
#include "oraclegs/formats/sog_writer.h"
#include "oraclegs/formats/spatial_order.h"
#include "oraclegs/formats/splat.h"
#include "oraclegs/formats/spz.h"
#include "oraclegs/gaussians/selection.h"

namespace oraclegs {
namespace {

namespace fs = std::filesystem;

constexpr int kMaxPasses = 4;      // writing again what a pass has lost
constexpr int64_t kLostOf = 1000;  // one Gaussian in so many may be left out of a file that cannot hold it
constexpr int64_t kCutOf = 10;     // from one in so many on, cut colors are a warning
constexpr const char* kKsplat = ".ksplat";

enum class FileOrder { kKept, kByPlace };

struct SplatFormatRow {
  SplatFormat format;
  const char* extension;
  FileOrder order;
  SplatPromise promise;  // docs/formats.md has the same numbers
};

constexpr float kAny = std::numeric_limits<float>::infinity();
constexpr SplatPromise kFloats{0, 1e-4f, 0, -kAny, kAny, 0, kAny};
constexpr SplatPromise kSpzPromise{0.25f, 1 / 32.f, 0.0038f, -0.443f, 1.443f, 1 / 16.f, 1};
constexpr SplatPromise kChunkPromise{1, 0.02f, 0.034f, kLowestColor, kHighestColor, 1 / 64.f, kLargestHarmonic};
constexpr SplatPromise kSogPromise{0.25f, 0.7f, 0.25f, kLowestColor, kHighestColor, kAny, kLargestHarmonic};
constexpr SplatPromise kSplatPromise{0, 1e-4f, 1 / 510.f, 0, 1, 0, 0};

// Longer ends first: every .compressed.ply ends in .ply too, and every .spz.glb in .glb.
constexpr SplatFormatRow kSplatFormats[] = {
    {SplatFormat::kCompressedPly, ".compressed.ply", FileOrder::kByPlace, kChunkPromise},
    {SplatFormat::kPly, ".ply", FileOrder::kKept, kFloats},
    {SplatFormat::kSpz, ".spz", FileOrder::kByPlace, kSpzPromise},
    {SplatFormat::kSog, ".sog", FileOrder::kByPlace, kSogPromise},
    {SplatFormat::kSplat, ".splat", FileOrder::kKept, kSplatPromise},
    {SplatFormat::kGltfSpz, ".spz.glb", FileOrder::kByPlace, kSpzPromise},
    {SplatFormat::kGltf, ".glb", FileOrder::kKept, kFloats},
};

std::string LowerName(const fs::path& path) {
  std::string name = path.filename().string();
  std::transform(name.begin(), name.end(), name.begin(), [](unsigned char c) { return std::tolower(c); });
  return name;
}

const SplatFormatRow* FindFormat(const fs::path& path) {
  const std::string name = LowerName(path);
  for (const SplatFormatRow& row : kSplatFormats) {
    if (name.size() > std::strlen(row.extension) && name.ends_with(row.extension)) return &row;
  }
  return nullptr;
}

const SplatFormatRow& RowOf(SplatFormat format) {
  const auto* const row = std::find_if(std::begin(kSplatFormats), std::end(kSplatFormats),
                                       [&](const SplatFormatRow& r) { return r.format == format; });
  return *row;
}

/// Looks at the header only: the body comes into memory once, by the reader that it is for.
bool HoldsCompressedPly(const fs::path& path) {
  return IsCompressedPly(ParsePlyHeader(MapFile(path).bytes, path.string()));
}

GaussianPly Decode(SplatFormat format, std::string_view bytes, const std::string& file) {
  switch (format) {
    case SplatFormat::kPly:
      return DecodeGaussianPly(bytes, file);
    case SplatFormat::kCompressedPly:
      return DecodeCompressedPly(bytes, file);
    case SplatFormat::kSplat:
      return DecodeSplat(bytes, file);
    case SplatFormat::kSpz:
      return DecodeSpz(bytes, file);
    case SplatFormat::kSog:
      return DecodeSog(bytes, file);
    case SplatFormat::kGltf:
    case SplatFormat::kGltfSpz:
      return DecodeGltf(bytes, file);
  }
  return {};
}

std::string Encode(SplatFormat format, const GaussianPly& splat) {
  const Gaussians& g = splat.gaussians;
  std::vector<std::string> comments = splat.comments;
  if (splat.antialiased && !SaysAntialiased(comments)) comments.emplace_back(kAntialiasedComment);
  switch (format) {
    case SplatFormat::kPly:
      return EncodeGaussianPly(g, splat.sh_degree, comments, splat.support);
    case SplatFormat::kCompressedPly:
      return EncodeCompressedPly(g, splat.sh_degree, comments);
    case SplatFormat::kSplat:
      return EncodeSplat(g);
    case SplatFormat::kSpz:
      return EncodeSpz(g, splat.sh_degree, SpzVersion::k3, splat.antialiased);
    case SplatFormat::kSog:
      return EncodeSog(g, splat.sh_degree, splat.support);
    case SplatFormat::kGltf:
      return EncodeGltf(g, splat.sh_degree, splat.support);
    case SplatFormat::kGltfSpz:
      return EncodeGltfSpz(g, splat.sh_degree);
  }
  return {};
}

bool KeepsAntialiased(SplatFormat format) {
  return format == SplatFormat::kPly || format == SplatFormat::kCompressedPly || format == SplatFormat::kSpz;
}

GaussianPly ReadAny(const fs::path& path) {
  if (IsSogFolder(path)) return ReadSogFolder(path);
  if (path.filename() == "meta.json" && IsSogFolder(path.parent_path())) return ReadSogFolder(path.parent_path());
  SplatFormat format = SplatFormatOf(path);
  if (format == SplatFormat::kPly || format == SplatFormat::kCompressedPly) {
    format = HoldsCompressedPly(path) ? SplatFormat::kCompressedPly : SplatFormat::kPly;
  }
  return Decode(format, ReadFile(path), path.string());
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
  picked.support = Picked(splat.support, rows);
  return picked;
}

/// Reads the bytes as the program's own reader does. Throws InputError when it is not as many Gaussians.
Gaussians ReadBack(SplatFormat format, std::string_view bytes, const GaussianPly& given, const std::string& file) {
  std::string why = "it would lack Gaussians";
  try {
    GaussianPly read = Decode(format, bytes, file);
    if (read.gaussians.size() == given.gaussians.size() && read.sh_degree == given.sh_degree) return read.gaussians;
  } catch (const InputError& error) {
    why = error.what();
  }
  throw InputError("{}: could not be read again, so nothing was written: {}; take .ply or .glb", file, why);
}

}  // namespace

SplatFormat SplatFormatOf(const fs::path& path) {
  const SplatFormatRow* row = FindFormat(path);
  if (row != nullptr) return row->format;
  if (LowerName(path).ends_with(kKsplat)) {
    throw UsageError(
        "{}: .ksplat is the private format of one viewer and is not read; convert it to .ply, for example with "
        "SuperSplat "
        "or splat-transform",
        path.string());
  }
  std::string known;
  for (const SplatFormatRow& r : kSplatFormats) known += known.empty() ? r.extension : std::string(", ") + r.extension;
  throw UsageError("{}: is no known splat format; give a file name that ends in one of {}", path.string(), known);
}

bool HasSplatFormat(const fs::path& path) { return FindFormat(path) != nullptr; }

const char* ExtensionOf(SplatFormat format) { return RowOf(format).extension; }

bool IsSplatFolder(const fs::path& path) { return IsSogFolder(path); }

GaussianPly ReadSplat(const fs::path& path, const Listener& listener) {
  GaussianPly splat = ReadAny(path);
  for (const std::string& warning : splat.warnings) listener(Warning{warning});
  return splat;
}

int64_t WriteSplat(const fs::path& path, const GaussianPly& splat, const Listener& listener) {
  const SplatFormatRow& row = RowOf(SplatFormatOf(path));
  const std::string file = path.string();
  GaussianPly kept = splat;
  kept.gaussians.Check("WriteSplat");
  if (row.format == SplatFormat::kSplat) kept.sh_degree = 0;
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
          file, all - static_cast<int64_t>(rows.size()), all, row.extension, why);
    }
    if (static_cast<int64_t>(rows.size()) < kept.gaussians.size()) kept = PickedSplat(kept, rows);
    if (row.order == FileOrder::kByPlace) kept = PickedSplat(kept, SpatialOrder(kept.gaussians));
    bytes = Encode(row.format, kept);
    check = CheckPromise(kept.gaussians, ReadBack(row.format, bytes, kept, file), row.promise);
    if (check.lost.empty()) break;
    if (why.empty()) why = check.first;
    rows = OthersThan(check.lost, kept.gaussians.size());
  }
  const int64_t left = kept.gaussians.size();
  if (left < all) {
    listener(Warning{fmt::format("{}: {} of {} Gaussians are left out, because {} does not keep them ({})", file,
                                 all - left, all, row.extension, why)});
  }
  if (check.cut > 0) {
    const std::string text = fmt::format("{}: colors of {} of {} Gaussians reach beyond what {} holds and are cut",
                                         file, check.cut, left, row.extension);
    listener(check.cut * kCutOf > left ? Event(Warning{text}) : Event(Note{text}));
  }
  if (kept.antialiased && !KeepsAntialiased(row.format)) {
    listener(Warning{fmt::format("{}: {} cannot say that the model was trained antialiased; choose that in the viewer",
                                 file, row.extension)});
  }
  WriteFileAtomically(path, bytes);
  return left;
}

}  // namespace oraclegs
