#pragma once
// The de-facto 3DGS point cloud file (docs/method.md#ply-and-checkpoint).

#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

#include "oraclegs/gaussians/gaussians.h"
#include "oraclegs/gaussians/selection.h"

namespace oraclegs {

/// Writes binary little-endian PLY of SH degree `sh_degree` (0..3), atomically; comments stand in its header, a line
/// each. `marks` are the last properties of each Gaussian, which other viewers ignore. Throws RunError.
void WriteGaussianPly(const std::filesystem::path& path, const Gaussians& gaussians, int sh_degree = kMaxShDegree,
                      const std::vector<std::string>& comments = {}, const GaussianMarks& marks = {});

struct GaussianPly {
  Gaussians gaussians;
  int sh_degree = 0;  ///< degree of the file; higher coefficients are zero
  std::vector<std::string> comments = {};
  GaussianMarks marks = {};
  bool antialiased = false;                ///< the file says that it was trained so (docs/method.md#antialiasing)
  std::vector<std::string> warnings = {};  ///< what the reader left out or assumed: lines that name the file
};

/// The comment of a PLY whose model was trained antialiased, as other trainers write it.
inline constexpr char kAntialiasedComment[] = "SplatRenderMode: mip";
/// True where the last comment about it says so, in these words or in Postshot's ("antialiased 1").
bool SaysAntialiased(const std::vector<std::string>& comments);

/// Reads such a file from any trainer: properties found by name in any order, other properties and elements skipped,
/// ascii and both binary byte orders, float or double. Harmonics of degree 4 are read to degree 3, and Gaussians of two
/// scales (discs) get a third scale, a thousandth of the smaller one, and the 3D filter of Mip-Splatting is applied
/// and taken as a mark of antialiased training, each with a warning; rows as LeaveOutDamaged says. Throws InputError
/// naming the file: no such element or property, a vertex count that the file cannot hold, too many damaged rows, a
/// mark outside [0, 1].
GaussianPly ReadGaussianPly(const std::filesystem::path& path);

/// Reads a file that this program wrote. Also throws InputError for what ReadGaussianPly would leave out or assume.
GaussianPly ReadIntactGaussianPly(const std::filesystem::path& path);

/// The warning that harmonics of this degree are not read above kMaxShDegree.
std::string DegreeLeftOut(int degree, const std::string& file);

/// The bytes of such a file, and back; `file` stands in errors.
std::string EncodeGaussianPly(const Gaussians& gaussians, int sh_degree, const std::vector<std::string>& comments,
                              const GaussianMarks& marks);
GaussianPly DecodeGaussianPly(std::string_view bytes, const std::string& file);

}  // namespace oraclegs
