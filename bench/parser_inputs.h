#pragma once
// Files of growing size for every parser: usual ones, and those of many tiny parts, equal names or long chains.

#include <cstddef>
#include <functional>
#include <string>
#include <vector>

namespace oraclegs {

struct ParserInput {
  std::string parser, input;
  std::function<std::string(size_t bytes)> make;      ///< a file of about that many bytes
  std::function<void(const std::string& file)> read;  ///< may throw Error
};

std::vector<ParserInput> SplatInputs();
std::vector<ParserInput> SceneInputs();
std::vector<ParserInput> OtherInputs();

/// Concatenated pieces with a running number, up to that many bytes.
std::string Repeated(size_t bytes, const std::function<std::string(size_t index)>& piece);

}  // namespace oraclegs
