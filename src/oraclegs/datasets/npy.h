#pragma once
// NumPy's arrays on disk (.npy).

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

namespace oraclegs {

struct NpyArray {
  std::vector<int64_t> shape;
  std::vector<double> values;  ///< row by row (C order), whatever the order in the file

  /// "20 x 17"; "a single number" without axes.
  std::string ShapeWords() const;
};

/// An array of little-endian 32-bit or 64-bit floats. Throws InputError naming `file`: no .npy, cut short, other
/// numbers (with the line of Python that converts them), a shape that does not fit the bytes.
NpyArray ParseNpy(std::string_view bytes, const std::string& file);

}  // namespace oraclegs
