#include "oraclegs/formats/codecs.h"

#include <algorithm>
#include <cmath>

#include "oraclegs/core/parallel.h"
#include "oraclegs/core/statistics.h"
#include "oraclegs/scene/frame_comments.h"

namespace oraclegs {
namespace {

constexpr int64_t kChunk = 256;  // Gaussians
constexpr const char* kBoundNames[] = {
    "min_x",       "min_y",       "min_z",       "max_x", "max_y", "max_z", "min_scale_x", "min_scale_y", "min_scale_z",
    "max_scale_x", "max_scale_y", "max_scale_z", "min_r", "min_g", "min_b", "max_r",       "max_g",       "max_b"};
constexpr int kBounds = 18, kBoundsWithoutColor = 12;
constexpr const char* kPackedNames[] = {"packed_position", "packed_rotation", "packed_scale", "packed_color"};
constexpr int kPacked = 4;
constexpr float kShRange = 2 * kLargestHarmonic;
constexpr float kLargestLogScale = 20;
constexpr float kHalfSqrt = 0.70710678f;

/// A number in [0,1] as an integer of so many bits, and back.
uint32_t PackUnit(float value, int bits) {
  const auto top = static_cast<float>((1u << bits) - 1);
  return static_cast<uint32_t>(std::lround(std::clamp(value, 0.f, 1.f) * top));
}
float UnpackUnit(uint32_t packed, int bits) {
  const uint32_t top = (1u << bits) - 1;
  return static_cast<float>(packed & top) / static_cast<float>(top);
}

uint32_t Pack3(const std::array<float, 3>& v) {
  return PackUnit(v[0], 11) << 21 | PackUnit(v[1], 10) << 11 | PackUnit(v[2], 11);
}
std::array<float, 3> Unpack3(uint32_t packed) {
  return {UnpackUnit(packed >> 21, 11), UnpackUnit(packed >> 11, 10), UnpackUnit(packed, 11)};
}

uint32_t PackRotation(const float* wxyz) {
  const SmallestThree rotation = DropLargest(UnitQuaternion(wxyz));
  auto packed = static_cast<uint32_t>(rotation.largest);
  for (const float c : rotation.others) packed = packed << 10 | PackUnit(c * kHalfSqrt + 0.5f, 10);
  return packed;
}
std::array<float, 4> UnpackRotation(uint32_t packed) {
  SmallestThree rotation{static_cast<int>(packed >> 30), {}};
  for (int i = 0; i < 3; ++i) rotation.others[i] = (UnpackUnit(packed >> (10 * (2 - i)), 10) - 0.5f) / kHalfSqrt;
  return RestoreLargest(rotation);
}

/// Position, log scales and color of a Gaussian: what the bounds of a chunk are of.
std::array<float, 9> BoundedValues(const GaussianRows& g) {
  std::array<float, 9> v;
  for (int c = 0; c < 3; ++c) {
    v[c] = g.means[c];
    v[3 + c] = std::clamp(g.log_scales[c], -kLargestLogScale, kLargestLogScale);
    v[6 + c] = std::clamp(g.sh[c] * static_cast<float>(kConstantSh) + 0.5f, kLowestColor, kHighestColor);
  }
  return v;
}

/// Where the lower bound of BoundedValues' entry i stands; the upper one stands three later.
constexpr int LowerBound(int i) { return 6 * (i / 3) + i % 3; }

void WriteChunk(const GaussianRows& first, int64_t count, char* bounds, char* packed) {
  std::array<float, kBounds> b;
  for (int i = 0; i < 9; ++i) {
    b[LowerBound(i)] = INFINITY;
    b[LowerBound(i) + 3] = -INFINITY;
  }
  for (int64_t k = 0; k < count; ++k) {
    const std::array<float, 9> v = BoundedValues(first.From(k));
    for (int i = 0; i < 9; ++i) {
      b[LowerBound(i)] = std::min(b[LowerBound(i)], v[i]);
      b[LowerBound(i) + 3] = std::max(b[LowerBound(i) + 3], v[i]);
    }
  }
  std::memcpy(bounds, b.data(), sizeof(b));
  for (int64_t k = 0; k < count; ++k) {
    const GaussianRows g = first.From(k);
    std::array<float, 9> v = BoundedValues(g);
    for (int i = 0; i < 9; ++i) {
      const double low = b[LowerBound(i)], range = b[LowerBound(i) + 3] - low;  // of floats, which it may exceed
      v[i] = range > 0 ? static_cast<float>((v[i] - low) / range) : 0;
    }
    const uint32_t row[kPacked] = {Pack3({v[0], v[1], v[2]}), PackRotation(g.quats), Pack3({v[3], v[4], v[5]}),
                                   PackUnit(v[6], 8) << 24 | PackUnit(v[7], 8) << 16 | PackUnit(v[8], 8) << 8 |
                                       PackUnit(Sigmoid(g.opacity_logits[0]), 8)};
    std::memcpy(packed + k * sizeof(row), row, sizeof(row));
  }
}

/// The rows of an element without lists in a little-endian file.
struct PlyRows {
  const PlyElement* element;
  std::string_view bytes;
  size_t stride;

  /// Offset of a property in a row. Throws unless it is there and of that type.
  size_t OffsetOf(const std::string& name, PlyType type, const std::string& file) const {
    size_t offset = 0;
    for (const PlyProperty& p : element->properties) {
      if (p.name == name && p.type == type) return offset;
      offset += PlySize(p.type);
    }
    throw InputError("{}: element '{}' has no property '{}' of the type of a compressed splat", file, element->name,
                     name);
  }
};

/// The elements in file order. Throws when the file cannot hold them.
std::vector<PlyRows> TablesOf(std::string_view bytes, const PlyHeader& header, const std::string& file) {
  if (header.format != PlyFormat::kLittleEndian) {
    throw InputError("{}: a compressed splat must be binary_little_endian; export it again", file);
  }
  std::vector<PlyRows> tables;
  size_t at = header.body;
  for (const PlyElement& element : header.elements) {
    size_t stride = 0;
    for (const PlyProperty& p : element.properties) {
      if (p.is_list) throw InputError("{}: has a list '{}', which a compressed splat has not", file, p.name);
      stride += PlySize(p.type);
    }
    if (stride == 0 || element.count > (bytes.size() - at) / stride) {
      throw InputError("{}: promises {} of element '{}', more than its bytes hold; copy it again", file, element.count,
                       element.name);
    }
    tables.push_back({&element, bytes.substr(at, element.count * stride), stride});
    at += element.count * stride;
  }
  return tables;
}

/// Bounds of all chunks, [chunks, 18]; color from 0 to 1 where the file has no bounds of it.
std::vector<float> BoundsOf(const PlyRows& chunk, const std::string& file) {
  const int count = chunk.element->Find("min_r") >= 0 ? kBounds : kBoundsWithoutColor;
  std::vector<float> bounds(chunk.element->count * kBounds);
  for (int b = 0; b < kBounds; ++b) {
    const size_t offset = b < count ? chunk.OffsetOf(kBoundNames[b], PlyType::kFloat, file) : 0;
    for (uint64_t i = 0; i < chunk.element->count; ++i) {
      bounds[i * kBounds + b] =
          b < count ? LoadLittle<float>(chunk.bytes, i * chunk.stride + offset) : static_cast<float>(b >= kBounds - 3);
    }
  }
  return bounds;
}

/// Degree of the harmonics in an element 'sh'.
int CompressedDegree(const PlyRows& sh, uint64_t count, const std::string& file) {
  for (int degree = 1; degree <= kMaxShDegree; ++degree) {
    if (sh.stride == static_cast<size_t>(3 * (ShCount(degree) - 1)) && sh.element->count == count) return degree;
  }
  throw InputError("{}: element 'sh' has {} rows of {} bytes, expected {} rows of 9, 24 or 45", file, sh.element->count,
                   sh.stride, count);
}

void ReadHarmonics(const PlyRows& rows, int degree, const GaussianRows& all) {
  const int per_channel = ShCount(degree) - 1;
  ParallelBlocks(static_cast<int64_t>(rows.element->count), kSplatGrain, [&](int64_t begin, int64_t end) {
    for (int64_t i = begin; i < end; ++i) {
      const char* in = rows.bytes.data() + static_cast<size_t>(i) * rows.stride;
      float* sh = all.From(i).sh;
      for (int c = 0; c < 3; ++c) {
        for (int k = 0; k < per_channel; ++k) {
          const auto byte = static_cast<float>(static_cast<uint8_t>(in[c * per_channel + k]));
          sh[3 * (k + 1) + c] = ((byte + 0.5f) / 256 - 0.5f) * kShRange;
        }
      }
    }
  });
}

}  // namespace

std::string EncodeCompressedPly(const Gaussians& gaussians, int sh_degree, const std::vector<std::string>& comments) {
  gaussians.Check("EncodeCompressedPly");
  const Gaussians sorted = gaussians.To(kCpu);
  const int64_t n = sorted.size(), chunks = (n + kChunk - 1) / kChunk;
  const int per_channel = ShCount(sh_degree) - 1;
  std::string bytes = "ply\nformat binary_little_endian 1.0\n";
  for (std::string comment : comments) {
    std::replace_if(
        comment.begin(), comment.end(), [](char c) { return c == '\n' || c == '\r'; }, ' ');
    bytes += "comment " + comment + "\n";
  }
  bytes += fmt::format("element chunk {}\n", chunks);
  for (const char* name : kBoundNames) bytes += fmt::format("property float {}\n", name);
  bytes += fmt::format("element vertex {}\n", n);
  for (const char* name : kPackedNames) bytes += fmt::format("property uint {}\n", name);
  if (per_channel > 0) bytes += fmt::format("element sh {}\n", n);
  for (int k = 0; k < 3 * per_channel; ++k) bytes += fmt::format("property uchar f_rest_{}\n", k);
  bytes += "end_header\n";

  const size_t bounds = bytes.size(), packed = bounds + chunks * kBounds * sizeof(float);
  const size_t sh = packed + n * kPacked * sizeof(uint32_t);
  bytes.resize(sh + n * 3 * per_channel);
  const GaussianRows all = sorted.Rows();
  ParallelFor(chunks, [&](int64_t chunk) {
    const int64_t begin = chunk * kChunk, count = std::min(kChunk, n - begin);
    WriteChunk(all.From(begin), count, bytes.data() + bounds + chunk * kBounds * sizeof(float),
               bytes.data() + packed + begin * kPacked * sizeof(uint32_t));
    for (int64_t i = begin; i < begin + count; ++i) {
      char* out = bytes.data() + sh + i * 3 * per_channel;
      for (int c = 0; c < 3; ++c) {
        for (int k = 1; k <= per_channel; ++k) {
          // The middle of a byte's interval is what it is read as.
          *out++ = static_cast<char>(NearestByte((all.From(i).sh[3 * k + c] / kShRange + 0.5f) * 256 - 0.5f));
        }
      }
    }
  });
  return bytes;
}

bool IsCompressedPly(const PlyHeader& header) {
  const int vertex = header.Find("vertex");
  return header.Find("chunk") >= 0 && vertex >= 0 && header.elements[vertex].Find(kPackedNames[0]) >= 0;
}

GaussianPly DecodeCompressedPly(std::string_view bytes, const std::string& file) {
  const PlyHeader header = ParsePlyHeader(bytes, file);
  if (!IsCompressedPly(header)) {
    throw InputError("{}: is not a compressed splat; rename it to end in .ply if it is a plain one", file);
  }
  const std::vector<PlyRows> tables = TablesOf(bytes, header, file);
  const PlyRows& vertex = tables[header.Find("vertex")];
  const PlyRows& chunk = tables[header.Find("chunk")];
  const uint64_t n = vertex.element->count;
  if (chunk.element->count != (n + kChunk - 1) / kChunk) {
    throw InputError("{}: has {} chunks for {} Gaussians, expected one for each {}", file, chunk.element->count, n,
                     kChunk);
  }
  const int sh = header.Find("sh");
  const int degree = sh < 0 ? 0 : CompressedDegree(tables[sh], n, file);
  size_t offsets[kPacked];  // before memory is taken: rows of fewer bytes could promise any number of Gaussians
  for (int i = 0; i < kPacked; ++i) offsets[i] = vertex.OffsetOf(kPackedNames[i], PlyType::kUint32, file);
  const std::vector<float> bounds = BoundsOf(chunk, file);
  GaussianPly splat = ZeroSplat(static_cast<int64_t>(n), degree, file);
  splat.comments = header.comments;
  splat.antialiased = SaysAntialiased(header.comments);
  const GaussianRows all = splat.gaussians.Rows();
  ParallelBlocks(static_cast<int64_t>(n), kChunk, [&](int64_t begin, int64_t end) {
    const float* b = bounds.data() + begin / kChunk * kBounds;
    for (int64_t i = begin; i < end; ++i) {
      const size_t row = static_cast<size_t>(i) * vertex.stride;
      const auto packed = [&](int k) { return LoadLittle<uint32_t>(vertex.bytes, row + offsets[k]); };
      const std::array<float, 3> position = Unpack3(packed(0)), scale = Unpack3(packed(2));
      const GaussianRows g = all.From(i);
      const auto within = [b](int lower, float t) { return b[lower] * (1 - t) + b[lower + 3] * t; };
      for (int c = 0; c < 3; ++c) {
        g.means[c] = within(c, position[c]);
        g.log_scales[c] = within(6 + c, scale[c]);
        g.sh[c] = (within(12 + c, UnpackUnit(packed(3) >> (8 * (3 - c)), 8)) - 0.5f) / static_cast<float>(kConstantSh);
      }
      g.opacity_logits[0] = LogitOfOpacity(UnpackUnit(packed(3), 8));
      std::copy_n(UnpackRotation(packed(1)).data(), 4, g.quats);
    }
  });
  if (sh >= 0) ReadHarmonics(tables[sh], splat.sh_degree, all);
  return WithoutDamaged(std::move(splat), file);
}

}  // namespace oraclegs
