#pragma once
// The numbers of the PLY container, ascii or binary.

#include <string>
#include <string_view>
#include <vector>

#include "oraclegs/gaussians/ply_header.h"

namespace oraclegs {

/// The named scalar properties of an element as rows * names floats, row-major. Throws InputError naming `file`: no
/// such element or property, a list among them, more rows than the bytes can hold (nothing is allocated before that is
/// known), something that is not a number.
std::vector<float> ReadPlyColumns(std::string_view bytes, const PlyHeader& header, std::string_view element,
                                  const std::vector<std::string>& names, const std::string& file);

}  // namespace oraclegs
