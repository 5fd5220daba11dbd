#pragma once
// The PLY container: its text header, which says what elements follow and of which scalar or list properties, and its
// numbers, ascii or binary.

#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

namespace oraclegs {

enum class PlyFormat { kAscii, kLittleEndian, kBigEndian };
enum class PlyType { kInt8, kUint8, kInt16, kUint16, kInt32, kUint32, kFloat, kDouble };

/// Bytes of one number in a binary file.
size_t PlySize(PlyType type);

struct PlyProperty {
  std::string name;
  PlyType type = PlyType::kFloat;
  bool is_list = false;
  PlyType count_type = PlyType::kUint8;  ///< type of a list's length
};

struct PlyElement {
  std::string name;
  uint64_t count = 0;
  std::vector<PlyProperty> properties;

  /// Index of a property, -1 when there is none.
  int Find(std::string_view property) const;
};

struct PlyHeader {
  PlyFormat format = PlyFormat::kAscii;
  std::vector<PlyElement> elements;        ///< in file order
  size_t body = 0;                         ///< offset of the first byte after the header
  std::vector<std::string> comments = {};  ///< the texts of its "comment" lines, cut where they are very long

  /// Index of an element, -1 when there is none.
  int Find(std::string_view element) const;
};

/// Throws InputError naming `file` and the line: not a PLY, an unknown keyword or type, a name given twice, an end
/// before end_header.
PlyHeader ParsePlyHeader(std::string_view bytes, const std::string& file);

/// The named scalar properties of an element as rows * names floats, row-major. Throws InputError naming `file`: no
/// such element or property, a list among them, more rows than the bytes can hold (nothing is allocated before that is
/// known), something that is not a number.
std::vector<float> ReadPlyColumns(std::string_view bytes, const PlyHeader& header, std::string_view element,
                                  const std::vector<std::string>& names, const std::string& file);

}  // namespace oraclegs
