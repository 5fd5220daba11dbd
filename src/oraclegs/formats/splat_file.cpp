#include "oraclegs/formats/splat_file.h"

#include <algorithm>
#include <cctype>

#include "oraclegs/core/files.h"
#include "oraclegs/core/mapped_file.h"
#include "oraclegs/formats/compressed_ply.h"
#include "oraclegs/formats/gltf_reader.h"
#include "oraclegs/formats/gltf_writer.h"
#include "oraclegs/formats/sog_reader.h"
#include "oraclegs/formats/sog_writer.h"
#include "oraclegs/formats/spatial_order.h"
#include "oraclegs/formats/splat.h"
#include "oraclegs/formats/spz.h"
#include "oraclegs/gaussians/selection.h"

namespace oraclegs {
namespace {

namespace fs = std::filesystem;

struct SplatFormatRow {
  SplatFormat format;
  const char* extension;
};

// Longer ends first: every .compressed.ply ends in .ply too, and every .spz.glb in .glb.
constexpr SplatFormatRow kSplatFormats[] = {
    {SplatFormat::kCompressedPly, ".compressed.ply"},
    {SplatFormat::kPly, ".ply"},
    {SplatFormat::kSpz, ".spz"},
    {SplatFormat::kSog, ".sog"},
    {SplatFormat::kSplat, ".splat"},
    {SplatFormat::kGltfSpz, ".spz.glb"},
    {SplatFormat::kGltf, ".glb"},
};

const SplatFormatRow* FindFormat(const fs::path& path) {
  std::string name = path.filename().string();
  std::transform(name.begin(), name.end(), name.begin(), [](unsigned char c) { return std::tolower(c); });
  for (const SplatFormatRow& row : kSplatFormats) {
    if (name.size() > std::strlen(row.extension) && name.ends_with(row.extension)) return &row;
  }
  return nullptr;
}

/// Looks at the header only: the body comes into memory once, by the reader that it is for.
bool HoldsCompressedPly(const fs::path& path) {
  return IsCompressedPly(ParsePlyHeader(MapFile(path).bytes, path.string()));
}

}  // namespace

SplatFormat SplatFormatOf(const fs::path& path) {
  const SplatFormatRow* row = FindFormat(path);
  if (row != nullptr) return row->format;
  std::string known;
  for (const SplatFormatRow& r : kSplatFormats) known += known.empty() ? r.extension : std::string(", ") + r.extension;
  throw UsageError("{}: is no known splat format; give a file name that ends in one of {}", path.string(), known);
}

bool HasSplatFormat(const fs::path& path) { return FindFormat(path) != nullptr; }

const char* ExtensionOf(SplatFormat format) {
  for (const SplatFormatRow& row : kSplatFormats) {
    if (row.format == format) return row.extension;
  }
  return "";
}

GaussianPly ReadSplat(const fs::path& path) {
  const SplatFormat format = SplatFormatOf(path);
  const bool is_ply = format == SplatFormat::kPly || format == SplatFormat::kCompressedPly;
  if (is_ply && !HoldsCompressedPly(path)) return ReadGaussianPly(path);
  const std::string file = path.string(), bytes = ReadFile(path);
  switch (format) {
    case SplatFormat::kPly:
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

void WriteSplat(const fs::path& path, const Gaussians& gaussians, int sh_degree,
                const std::vector<std::string>& comments, const std::vector<float>& support) {
  switch (SplatFormatOf(path)) {
    case SplatFormat::kPly:
      return WriteGaussianPly(path, gaussians, sh_degree, comments, support);
    case SplatFormat::kCompressedPly:
      return WriteFileAtomically(path, EncodeCompressedPly(gaussians, sh_degree, comments));
    case SplatFormat::kSplat:
      return WriteFileAtomically(path, EncodeSplat(gaussians));
    case SplatFormat::kSpz:
      return WriteFileAtomically(path, EncodeSpz(Picked(gaussians, SpatialOrder(gaussians)), sh_degree));
    case SplatFormat::kSog:
      return WriteFileAtomically(path, EncodeSog(gaussians, sh_degree, support));
    case SplatFormat::kGltf:
      return WriteFileAtomically(path, EncodeGltf(gaussians, sh_degree, support));
    case SplatFormat::kGltfSpz:
      return WriteFileAtomically(path, EncodeGltfSpz(gaussians, sh_degree));
  }
}

}  // namespace oraclegs
