#pragma once
// Which tensors the published file of a model holds. The lists are text files in lists/, compiled in; a line is
//   NAME SHAPE              blocks.{0-11}.norm.{weight,bias} 384    (braces: ranges and words; 1x3x14 = [1, 3, 14])
//   ?NAME SHAPE             may be absent
//   ignore BEGINNING        names that begin so may be there and are ignored
// They say what the floor networks asks for; a test compares the two. So `models check` needs no libtorch and no
// network has to be built for it.

#include <cstdint>
#include <map>
#include <string>
#include <string_view>
#include <vector>

namespace oraclegs {

struct ExpectedTensor {
  std::vector<int64_t> shape;
  bool optional = false;
};

struct ParameterList {
  std::map<std::string, ExpectedTensor> tensors;
  std::vector<std::string> ignored;  ///< beginnings of names

  bool Ignores(std::string_view name) const;
};

/// Throws std::logic_error for a malformed line or a name that comes twice: the lists are ours.
ParameterList ParseParameterList(std::string_view text);

/// The list of this name (WeightsInfo::parameters). Throws std::logic_error when there is none.
ParameterList ParametersOf(const std::string& list);

}  // namespace oraclegs
