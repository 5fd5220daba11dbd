#include "oraclegs/gaussians/ply.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstring>

#include "oraclegs/core/files.h"
#include "oraclegs/core/parallel.h"
#include "oraclegs/gaussians/ply_reader.h"

namespace oraclegs {
namespace {

static_assert(std::endian::native == std::endian::little, "rows are written as the machine stores them");

constexpr int64_t kWriteGrain = 4096;  // rows a task
constexpr int kFixedColumns = 14;      // what a reader needs besides f_rest: x y z, f_dc, opacity, scale, rot
constexpr int kFromOpacity = 8;        // columns from opacity to the end
constexpr float kMaxLogit = 15;
constexpr char kSupport[] = "support";

void Append(std::vector<std::string>* names, const char* stem, int count) {
  for (int i = 0; i < count; ++i) names->push_back(stem + std::to_string(i));
}

/// The properties in the order of the format, without the normals: 14 + 3 K.
std::vector<std::string> PropertyNames(int rest) {
  std::vector<std::string> names = {"x", "y", "z"};
  Append(&names, "f_dc_", 3);
  Append(&names, "f_rest_", rest);
  names.push_back("opacity");
  Append(&names, "scale_", 3);
  Append(&names, "rot_", 4);
  return names;
}

/// Floats of f_rest for a degree: three channels of all but the constant coefficient.
int RestCount(int degree) { return 3 * (ShCount(degree) - 1); }

std::string HeaderText(int64_t count, std::vector<std::string> names, bool has_support,
                       const std::vector<std::string>& comments) {
  if (has_support) names.emplace_back(kSupport);
  std::string text = "ply\nformat binary_little_endian 1.0\n";
  for (std::string comment : comments) {
    // A line break would be read as the next line of the header.
    std::replace_if(
        comment.begin(), comment.end(), [](char c) { return c == '\n' || c == '\r'; }, ' ');
    text += "comment " + comment + "\n";
  }
  text += fmt::format("element vertex {}\n", count);
  for (const std::string& name : names) {
    text += "property float " + name + "\n";
    if (name == "z") text += "property float nx\nproperty float ny\nproperty float nz\n";
  }
  return text + "end_header\n";
}

/// The first of the Gaussians to a row of PropertyNames order, with three zeros for the normal after the position.
void PackRow(const GaussianRows& from, int rest, float* out) {
  const int per_channel = rest / 3;
  out = std::copy_n(from.means, 3, out);
  out = std::fill_n(out, 3, 0.f);
  out = std::copy_n(from.sh, 3, out);
  for (int c = 0; c < 3; ++c) {
    for (int k = 1; k <= per_channel; ++k) *out++ = from.sh[3 * k + c];
  }
  *out++ = from.opacity_logits[0];
  out = std::copy_n(from.log_scales, 3, out);
  std::copy_n(from.quats, 4, out);
}

/// The reverse, of a row without the normal.
void UnpackRow(const float* in, int rest, const GaussianRows& to) {
  const int per_channel = rest / 3;
  std::copy_n(in, 3, to.means);
  std::copy_n(in + 3, 3, to.sh);
  in += 6;
  for (int c = 0; c < 3; ++c) {
    for (int k = 1; k <= per_channel; ++k) to.sh[3 * k + c] = *in++;
  }
  to.opacity_logits[0] = *in++;
  std::copy_n(in, 3, to.log_scales);
  std::copy_n(in + 3, 4, to.quats);
}

int DegreeOf(const PlyElement& vertex, const std::string& file) {
  int rest = 0;
  for (const PlyProperty& p : vertex.properties) rest += p.name.rfind("f_rest_", 0) == 0 ? 1 : 0;
  for (int degree = 0; degree <= kMaxShDegree; ++degree) {
    if (RestCount(degree) == rest) return degree;
  }
  throw InputError("{}: has {} f_rest properties, expected 0, 9, 24 or 45 (spherical harmonics of degree 0 to 3)", file,
                   rest);
}

/// An opacity of exactly 0 or 1, usual after a conversion from 8-bit alpha, has an infinite logit, which training
/// cannot change. It becomes the last opacity that float32 distinguishes from 0 or 1.
void ClampOpacity(float* logit) {
  if (std::isinf(*logit)) *logit = std::copysign(kMaxLogit, *logit);
}

/// The support of each Gaussian, where the file has it.
std::vector<float> ReadSupport(const std::string& bytes, const PlyHeader& header, const PlyElement& vertex,
                               const std::string& file) {
  const int at = vertex.Find(kSupport);
  if (at < 0 || vertex.properties[static_cast<size_t>(at)].is_list) return {};
  std::vector<float> support = ReadPlyColumns(bytes, header, vertex.name, {kSupport}, file);
  for (size_t i = 0; i < support.size(); ++i) {
    if (support[i] >= 0 && support[i] <= 1) continue;
    throw InputError("{}: support of vertex {} is {}, expected 0 to 1; remove that property or train again", file, i,
                     support[i]);
  }
  return support;
}

/// Throws for a number that would spoil every render.
void CheckRow(const float* row, const std::vector<std::string>& names, int64_t i, const std::string& file) {
  for (size_t c = 0; c < names.size(); ++c) {
    if (std::isfinite(row[c])) continue;
    throw InputError("{}: {} of vertex {} is {}; the training that wrote it diverged, export it again", file, names[c],
                     i, row[c]);
  }
  const float* q = row + names.size() - 4;
  const float squared = q[0] * q[0] + q[1] * q[1] + q[2] * q[2] + q[3] * q[3];  // by which a renderer divides
  if (std::isnormal(squared)) return;
  throw InputError("{}: rot_0 .. rot_3 of vertex {} are {}, which is no rotation; export it again", file, i,
                   squared < 1 ? "all zero" : "too large");
}

}  // namespace

void WriteGaussianPly(const std::filesystem::path& path, const Gaussians& gaussians, int sh_degree,
                      const std::vector<std::string>& comments, const std::vector<float>& support) {
  gaussians.Check("WriteGaussianPly");
  const bool has_support = !support.empty();
  if (has_support && static_cast<int64_t>(support.size()) != gaussians.size()) {
    throw ShapeError("WriteGaussianPly: support of {} Gaussians, expected {}", support.size(), gaussians.size());
  }
  if (sh_degree < 0 || sh_degree > kMaxShDegree) throw ShapeError("WriteGaussianPly: degree {}", sh_degree);
  const Gaussians host = gaussians.To(kCpu);
  const int64_t n = host.size();
  const int rest = RestCount(sh_degree);
  const size_t columns = kFixedColumns + 3 + rest + (has_support ? 1 : 0), row_bytes = columns * sizeof(float);
  std::string bytes = HeaderText(n, PropertyNames(rest), has_support, comments);
  const size_t header = bytes.size();
  bytes.resize(header + static_cast<size_t>(n) * row_bytes);
  const GaussianRows all = host.Rows();
  ParallelBlocks(n, kWriteGrain, [&](int64_t begin, int64_t end) {
    std::vector<float> row(columns);
    for (int64_t i = begin; i < end; ++i) {
      PackRow(all.From(i), rest, row.data());
      if (has_support) row.back() = support[static_cast<size_t>(i)];
      std::memcpy(bytes.data() + header + static_cast<size_t>(i) * row_bytes, row.data(), row_bytes);
    }
  });
  WriteFileAtomically(path, bytes);
}

GaussianPly ReadGaussianPly(const std::filesystem::path& path) {
  const std::string file = path.string();
  const std::string bytes = ReadFile(path);
  const PlyHeader header = ParsePlyHeader(bytes, file);
  const int vertex = header.Find("vertex");
  if (vertex < 0) throw InputError("{}: has no element 'vertex'; give a Gaussian point cloud", file);
  const PlyElement& element = header.elements[vertex];
  if (element.count == 0) throw InputError("{}: holds no Gaussians (element vertex 0)", file);

  GaussianPly out;
  out.sh_degree = DegreeOf(element, file);
  out.comments = header.comments;
  const int rest = RestCount(out.sh_degree);
  const std::vector<std::string> names = PropertyNames(rest);
  std::vector<float> values = ReadPlyColumns(bytes, header, element.name, names, file);
  out.support = ReadSupport(bytes, header, element, file);
  const auto n = static_cast<int64_t>(element.count);
  const auto columns = static_cast<int64_t>(names.size());
  out.gaussians = Gaussians::Zeros(n);
  const GaussianRows all = out.gaussians.Rows();
  ParallelBlocks(n, kWriteGrain, [&](int64_t begin, int64_t end) {
    for (int64_t i = begin; i < end; ++i) {
      float* row = values.data() + i * columns;
      ClampOpacity(row + columns - kFromOpacity);
      CheckRow(row, names, i, file);
      UnpackRow(row, rest, all.From(i));
    }
  });
  return out;
}

}  // namespace oraclegs
