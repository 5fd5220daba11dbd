#pragma once
// The compressed PLY of PlayCanvas and SuperSplat: chunks of 256 neighbors with bounds of their own, 16 bytes for each
// Gaussian within them, and a byte for each higher coefficient.

#include <string>
#include <string_view>
#include <vector>

#include "oraclegs/formats/values.h"
#include "oraclegs/gaussians/ply_header.h"

namespace oraclegs {

/// The bytes of a .compressed.ply file; the Gaussians keep their order, which should be spatial. Errors: positions and
/// log scales half a step of 1/2047 (y: 1/1023) of their chunk's range, color half of 1/255 of it within [-8, 9],
/// opacity 1/510, quaternion 1/1446 a component, harmonics 1/64 within [-4, 4].
std::string EncodeCompressedPly(const Gaussians& gaussians, int sh_degree, const std::vector<std::string>& comments);

/// True for a PLY that DecodeCompressedPly is made for.
bool IsCompressedPly(const PlyHeader& header);

/// Throws InputError naming `file`: no such PLY, lengths that do not fit, too many damaged rows.
GaussianPly DecodeCompressedPly(std::string_view bytes, const std::string& file);

}  // namespace oraclegs
