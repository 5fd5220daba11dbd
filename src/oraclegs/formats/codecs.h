#pragma once
// The bytes of splat files other than PLY, written and read. A format is a row of splat_file.cpp.

#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

#include "oraclegs/formats/values.h"
#include "oraclegs/gaussians/gaussians.h"
#include "oraclegs/gaussians/ply_header.h"

namespace oraclegs {

// glTF 2.0 in one binary file (.glb) with the ratified extension KHR_gaussian_splatting: a primitive of points, whose
// attributes are the Gaussians. glTF's axes are x left, y up, z forward, the program's x right, y down, z forward: what
// is written is turned by half a turn about the z axis.

/// The bytes of a .glb file: all attributes as float32, without loss but rounding, in the order of the Gaussians.
/// Viewers that do not know the extension show colored points. Support, if given, is the attribute _SUPPORT. Throws
/// RunError where the file would have more than 4 GB.
std::string EncodeGltf(const Gaussians& gaussians, int sh_degree, const std::vector<float>& support = {});

/// The bytes of a .glb that holds the Gaussians, in their order, as SPZ of version 2, whose errors it has: a draft of
/// an extension (KHR_gaussian_splatting_compression_spz_2), which a reader must know.
std::string EncodeGltfSpz(const Gaussians& gaussians, int sh_degree);

/// A .glb file: all primitives of the extension in all nodes, where their nodes put them, with
/// attributes of any type that it allows; also those that keep their Gaussians as SPZ. Throws InputError naming `file`:
/// no binary glTF or none with Gaussians, bytes outside the file, accessors that leave their bytes, nodes that are no
/// tree or scale unevenly, a mesh of Gaussians at two nodes, primitives that share bytes so often that the file
/// promises far more Gaussians than it can hold, too many damaged rows. Colors of the space lin_rec709_display
/// are converted, with a warning.
GaussianPly DecodeGltf(std::string_view bytes, const std::string& file);

// .splat: 32 bytes a Gaussian without a header, as the first viewers of the web read it. No view-dependent color.

/// Position and standard deviations as float32, color and opacity as bytes, w,x,y,z of the rotation as bytes; the
/// Gaussians keep their order. Errors: color and opacity 1/510, quaternion 1/128 a component; colors beyond [0,1] are
/// cut. Fast: a pass over the numbers.
std::string EncodeSplat(const Gaussians& gaussians);

/// Throws InputError naming `file`: a size that is no multiple of 32, numbers that are not finite.
GaussianPly DecodeSplat(std::string_view bytes, const std::string& file);

// The compressed PLY of PlayCanvas and SuperSplat: chunks of 256 neighbors with bounds of their own, 16 bytes for each
// Gaussian within them, and a byte for each higher coefficient.

/// The bytes of a .compressed.ply file; the Gaussians keep their order, which should be spatial. Errors: positions and
/// log scales half a step of 1/2047 (y: 1/1023) of their chunk's range, color half of 1/255 of it within [-8, 9],
/// opacity 1/510, quaternion 1/1446 a component, harmonics 1/64 within [-4, 4].
std::string EncodeCompressedPly(const Gaussians& gaussians, int sh_degree, const std::vector<std::string>& comments);

/// True for a PLY that DecodeCompressedPly is made for.
bool IsCompressedPly(const PlyHeader& header);

/// Throws InputError naming `file`: no such PLY, lengths that do not fit, too many damaged rows.
GaussianPly DecodeCompressedPly(std::string_view bytes, const std::string& file);

// SOG of PlayCanvas, version 2, in one file: a zip of WebP images, where each Gaussian is a pixel, and of meta.json.

/// The bytes of a .sog file; the Gaussians keep their order, which should be spatial. Errors: positions half of 1/65535
/// of the scene's range in sign(x) ln(1 + |x|), opacity 1/510, quaternion 1/360 a component; log scales (within [-20,
/// 20]) and color (within [-8, 9]) are the nearest of 256 values made for the scene, the harmonics above degree 0 of
/// each Gaussian (within [-4, 4]) the nearest of at most 16 384 sets. Support, if given, is an image of its own, which
/// other readers do not look at.
std::string EncodeSog(const Gaussians& gaussians, int sh_degree, const std::vector<float>& support = {},
                      bool antialiased = false);

/// A .sog file of version 2. Throws InputError naming `file`: no zip, no meta.json or one of another
/// version, images that are missing, damaged, or of another size than the number of Gaussians asks for.
GaussianPly DecodeSog(std::string_view bytes, const std::string& file);

/// True for a folder with the files of such an archive side by side: meta.json and its images.
bool IsSogFolder(const std::filesystem::path& folder);
/// Reads it, with the same errors.
GaussianPly ReadSogFolder(const std::filesystem::path& folder);

// OpenUSD as text (.usda), or that in a zip (.usdz): one prim of the schema ParticleField3DGaussianSplat. USD's axes
// with y up are those of SPZ.

/// The text: all numbers as float32, exact, in the order of the Gaussians; some 770 bytes a Gaussian of degree 3.
std::string EncodeUsda(const Gaussians& gaussians, int sh_degree, double meters_per_unit = 1);
std::string EncodeUsdz(const Gaussians& gaussians, int sh_degree, double meters_per_unit = 1);

/// All prims of the schema, where the prims above them put them, in floats or halves, y or z up; other prims are passed
/// over. A length of a unit other than a meter becomes a comment (scene/frame_comments.h). Throws InputError naming
/// `file`: the binary format; references and whatever else brings in prims from elsewhere; attributes that are missing,
/// move in time, or are not of as many Gaussians; transforms that scale unevenly. Linear colors are converted, with a
/// warning.
GaussianPly DecodeUsda(std::string_view bytes, const std::string& file);
/// Also: no zip, or one without a layer or with several.
GaussianPly DecodeUsdz(std::string_view bytes, const std::string& file);

// SPZ of Niantic: quantized Gaussians, attribute by attribute; versions 2 to 4 are written, 1 to 4 read. Its axes are
// x right, y up, z back, while the program's are x right, y down, z forward: what is written is turned by half a turn
// about the x axis, and turned back when it is read.

enum class SpzVersion {
  k2 = 2,  ///< rotations of 3 bytes; what glTF allows
  k3 = 3,  ///< rotations of 4 bytes, many times as exact
  k4 = 4,  ///< the same numbers, packed by zstd in place of gzip
};

/// The bytes of a .spz file; the Gaussians keep their order. Errors by the quantization: opacity 1/510, color 0.0037
/// within [-0.44, 1.44], log scales 1/32 within [-10, 5.9], quaternion 0.0007 a component (version 2: 0.004), harmonics
/// above degree 0 1/64 within [-1, 1] (1/32 and 1/16 for Gaussians of an opacity below 0.25 and 0.08); positions 1/32
/// of the median Gaussian's middle standard deviation, or up to 1/4 of it where 24 bits cannot hold the scene more
/// exactly. Where they do not hold that either, all but the farthest hundredth get the exactness that there is, and
/// what lies beyond the border stops there: WriteSplat refuses such files.
std::string EncodeSpz(const Gaussians& gaussians, int sh_degree, SpzVersion version = SpzVersion::k3,
                      bool antialiased = false);

/// Reads SPZ of versions 1 to 4; 1 to 3 also without gzip. Harmonics of degree 4 are read to degree 3 and extensions
/// are passed over, each with a warning. Throws InputError naming `file` (UnpackSpz).
GaussianPly DecodeSpz(std::string_view bytes, const std::string& file);

}  // namespace oraclegs
