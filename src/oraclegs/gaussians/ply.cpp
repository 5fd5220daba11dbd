#include "oraclegs/gaussians/ply.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstring>

#include "oraclegs/core/files.h"
#include "oraclegs/core/parallel.h"
#include "oraclegs/core/statistics.h"
#include "oraclegs/gaussians/damaged_rows.h"
#include "oraclegs/gaussians/ply_header.h"

namespace oraclegs {
namespace {

static_assert(std::endian::native == std::endian::little, "rows are written as the machine stores them");

constexpr int64_t kWriteGrain = 4096;          // rows a task
constexpr int kFixedColumns = 14;              // what a reader needs besides f_rest: x y z, f_dc, opacity, scale, rot
constexpr int kHighestDegree = 4;              // of files; what lies above kMaxShDegree is left out
constexpr float kLogOfThickness = -6.907755f;  // of a disc, relative to its smaller radius: a thousandth

constexpr char kMipFilter[] = "filter_3D";  // of Mip-Splatting, where it is not yet part of sizes and opacities

/// A list of marks and its property in a file.
struct Mark {
  const char* name;
  std::vector<float> GaussianMarks::*list;
};
constexpr std::array<Mark, 2> kMarks = {
    {{"support", &GaussianMarks::support}, {"uncertainty", &GaussianMarks::uncertainty}}};

/// The marks that are known.
std::vector<Mark> KnownMarks(const GaussianMarks& marks) {
  std::vector<Mark> known;
  for (const Mark& mark : kMarks) {
    if (!(marks.*mark.list).empty()) known.push_back(mark);
  }
  return known;
}

/// Meaning of the columns of a file.
struct RowLayout {
  int file_degree = 0;  // of its harmonics
  int scales = 3;       // 2 of discs

  int degree() const { return std::min(file_degree, kMaxShDegree); }
};

/// Floats of f_rest for a degree: three channels of all but the constant coefficient.
int RestCount(int degree) { return 3 * (ShCount(degree) - 1); }

void Append(std::vector<std::string>* names, const char* stem, int begin, int end) {
  for (int i = begin; i < end; ++i) names->push_back(stem + std::to_string(i));
}

/// The properties in the order of the format, without the normals and without what is left out: 14 + 3 K.
std::vector<std::string> PropertyNames(const RowLayout& layout) {
  std::vector<std::string> names = {"x", "y", "z"};
  Append(&names, "f_dc_", 0, 3);
  const int stored = ShCount(layout.file_degree) - 1, used = ShCount(layout.degree()) - 1;
  for (int channel = 0; channel < 3; ++channel) {
    Append(&names, "f_rest_", channel * stored, channel * stored + used);
  }
  names.push_back("opacity");
  Append(&names, "scale_", 0, layout.scales);
  Append(&names, "rot_", 0, 4);
  return names;
}

std::string HeaderText(int64_t count, const std::vector<std::string>& names, const std::vector<std::string>& comments) {
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
void UnpackRow(const float* in, const RowLayout& layout, const GaussianRows& to) {
  const int per_channel = ShCount(layout.degree()) - 1;
  std::copy_n(in, 3, to.means);
  std::copy_n(in + 3, 3, to.sh);
  in += 6;
  for (int c = 0; c < 3; ++c) {
    for (int k = 1; k <= per_channel; ++k) to.sh[3 * k + c] = *in++;
  }
  to.opacity_logits[0] = *in++;
  std::copy_n(in, layout.scales, to.log_scales);
  in += layout.scales;
  if (layout.scales == 2) to.log_scales[2] = std::min(to.log_scales[0], to.log_scales[1]) + kLogOfThickness;
  std::copy_n(in, 4, to.quats);
}

int DegreeOf(const PlyElement& vertex, const std::string& file) {
  int rest = 0;
  for (const PlyProperty& p : vertex.properties) rest += p.name.rfind("f_rest_", 0) == 0 ? 1 : 0;
  for (int degree = 0; degree <= kHighestDegree; ++degree) {
    if (RestCount(degree) == rest) return degree;
  }
  throw InputError("{}: has {} f_rest properties, expected 0, 9, 24, 45 or 72 (spherical harmonics of degree 0 to 4)",
                   file, rest);
}

/// The layout of a file's rows; what it makes the reader leave out or assume is added to the warnings.
RowLayout LayoutOf(const PlyElement& vertex, const std::string& file, std::vector<std::string>* warnings) {
  RowLayout layout;
  layout.file_degree = DegreeOf(vertex, file);
  if (layout.file_degree > kMaxShDegree) warnings->push_back(DegreeLeftOut(layout.file_degree, file));
  if (vertex.Find("scale_2") < 0 && vertex.Find("scale_1") >= 0) {
    layout.scales = 2;
    warnings->push_back(
        fmt::format("{}: its Gaussians have two scales: they are discs, and get a thickness of a thousandth of their "
                    "smaller radius",
                    file));
  }
  return layout;
}

/// The marks that the file has.
GaussianMarks ReadMarks(std::string_view bytes, const PlyHeader& header, const PlyElement& vertex,
                        const std::string& file) {
  GaussianMarks marks;
  for (const Mark& mark : kMarks) {
    const int at = vertex.Find(mark.name);
    if (at < 0 || vertex.properties[static_cast<size_t>(at)].is_list) continue;
    std::vector<float> values = ReadPlyColumns(bytes, header, vertex.name, {mark.name}, file);
    for (size_t i = 0; i < values.size(); ++i) {
      if (values[i] >= 0 && values[i] <= 1) continue;
      throw InputError("{}: {} of vertex {} is {}, expected 0 to 1; remove that property or train again", file,
                       mark.name, i, values[i]);
    }
    marks.*mark.list = std::move(values);
  }
  return marks;
}

/// Applies the filter that Mip-Splatting stores beside each Gaussian: a standard deviation in world units that widens
/// it, and dims it as much.
void ApplyFilters(const std::vector<float>& filters, Gaussians* gaussians) {
  const GaussianRows all = gaussians->Rows();
  for (size_t i = 0; i < filters.size(); ++i) {
    const GaussianRows g = all.From(static_cast<int64_t>(i));
    const double added = double{filters[i]} * double{filters[i]};
    double log_share = 0;  // of the opacity
    for (int c = 0; c < 3; ++c) {
      const double before = g.log_scales[c], after = 0.5 * std::log(std::exp(2 * before) + added);
      log_share += before - after;
      g.log_scales[c] = static_cast<float>(after);
    }
    const double opacity = double{Sigmoid(g.opacity_logits[0])} * std::exp(log_share);
    g.opacity_logits[0] = static_cast<float>(std::log(opacity) - std::log1p(-opacity));
  }
}

}  // namespace

bool SaysAntialiased(const std::vector<std::string>& comments) {
  bool says = false;
  for (const std::string& comment : comments) {
    if (comment.starts_with("SplatRenderMode: ")) says = comment == kAntialiasedComment;
    if (comment.starts_with("antialiased ")) says = comment == "antialiased 1";
  }
  return says;
}

std::string DegreeLeftOut(int degree, const std::string& file) {
  return fmt::format("{}: has spherical harmonics of degree {}; what is above degree {} is left out", file, degree,
                     kMaxShDegree);
}

std::string EncodeGaussianPly(const Gaussians& gaussians, int sh_degree, const std::vector<std::string>& comments,
                              const GaussianMarks& marks) {
  gaussians.Check("WriteGaussianPly");
  if (sh_degree < 0 || sh_degree > kMaxShDegree) throw ShapeError("WriteGaussianPly: degree {}", sh_degree);
  std::vector<std::string> names = PropertyNames({sh_degree, 3});
  const std::vector<Mark> known = KnownMarks(marks);
  for (const Mark& mark : known) {
    names.emplace_back(mark.name);
    if (const size_t count = (marks.*mark.list).size(); static_cast<int64_t>(count) != gaussians.size()) {
      throw ShapeError("WriteGaussianPly: {} of {} Gaussians, expected {}", mark.name, count, gaussians.size());
    }
  }
  const Gaussians host = gaussians.To(kCpu);
  const int64_t n = host.size();
  const int rest = RestCount(sh_degree);
  const size_t columns = kFixedColumns + 3 + rest + known.size(), row_bytes = columns * sizeof(float);
  std::string bytes = HeaderText(n, names, comments);
  const size_t header = bytes.size();
  bytes.resize(header + static_cast<size_t>(n) * row_bytes);
  const GaussianRows all = host.Rows();
  ParallelBlocks(n, kWriteGrain, [&](int64_t begin, int64_t end) {
    std::vector<float> row(columns);
    for (int64_t i = begin; i < end; ++i) {
      PackRow(all.From(i), rest, row.data());
      for (size_t k = 0; k < known.size(); ++k) {
        row[columns - known.size() + k] = (marks.*known[k].list)[static_cast<size_t>(i)];
      }
      std::memcpy(bytes.data() + header + static_cast<size_t>(i) * row_bytes, row.data(), row_bytes);
    }
  });
  return bytes;
}

void WriteGaussianPly(const std::filesystem::path& path, const Gaussians& gaussians, int sh_degree,
                      const std::vector<std::string>& comments, const GaussianMarks& marks) {
  WriteFileAtomically(path, EncodeGaussianPly(gaussians, sh_degree, comments, marks));
}

GaussianPly ReadGaussianPly(const std::filesystem::path& path) {
  return DecodeGaussianPly(ReadFile(path), path.string());
}

GaussianPly ReadIntactGaussianPly(const std::filesystem::path& path) {
  GaussianPly splat = ReadGaussianPly(path);
  if (!splat.warnings.empty()) throw InputError("{}", splat.warnings[0]);
  return splat;
}

GaussianPly DecodeGaussianPly(std::string_view bytes, const std::string& file) {
  const PlyHeader header = ParsePlyHeader(bytes, file);
  const int vertex = header.Find("vertex");
  if (vertex < 0) throw InputError("{}: has no element 'vertex'; give a Gaussian point cloud", file);
  const PlyElement& element = header.elements[vertex];
  if (element.count == 0) throw InputError("{}: holds no Gaussians (element vertex 0)", file);

  GaussianPly out;
  const RowLayout layout = LayoutOf(element, file, &out.warnings);
  out.sh_degree = layout.degree();
  out.comments = header.comments;
  out.antialiased = SaysAntialiased(out.comments);
  const std::vector<std::string> names = PropertyNames(layout);
  const std::vector<float> values = ReadPlyColumns(bytes, header, element.name, names, file);
  out.marks = ReadMarks(bytes, header, element, file);
  const auto n = static_cast<int64_t>(element.count);
  const auto columns = static_cast<int64_t>(names.size());
  out.gaussians = Gaussians::Zeros(n);
  const GaussianRows all = out.gaussians.Rows();
  ParallelBlocks(n, kWriteGrain, [&](int64_t begin, int64_t end) {
    for (int64_t i = begin; i < end; ++i) UnpackRow(values.data() + i * columns, layout, all.From(i));
  });
  if (element.Find(kMipFilter) >= 0) {
    ApplyFilters(ReadPlyColumns(bytes, header, element.name, {kMipFilter}, file), &out.gaussians);
    out.antialiased = true;
    out.warnings.push_back(fmt::format(
        "{}: has the 3D filter of Mip-Splatting, which is applied; the model is taken as trained antialiased", file));
  }
  LeaveOutDamaged(file, &out.gaussians, &out.marks, &out.warnings);
  return out;
}

}  // namespace oraclegs
