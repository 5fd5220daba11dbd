#pragma once
// Files of growing size for every parser: usual ones, and those of many tiny parts, equal names or long chains.

#include <cstddef>
#include <filesystem>
#include <functional>
#include <string>
#include <vector>

namespace oraclegs {

struct ParserInput {
  std::string parser, input;
  std::function<std::string(size_t bytes)> make;      ///< a file of about that many bytes
  std::function<void(const std::string& file)> read;  ///< may throw Error
  std::string placed = {};                            ///< its name in BenchFolder(), where `read` takes it from there
};

std::vector<ParserInput> SplatInputs();
std::vector<ParserInput> SceneInputs();
std::vector<ParserInput> DatasetInputs();
std::vector<ParserInput> PhotoInputs();
std::vector<ParserInput> WeightInputs();
std::vector<ParserInput> RunInputs();

/// A temporary folder, which the end of the program removes.
const std::filesystem::path& BenchFolder();

/// Concatenated pieces with a running number, up to that many bytes.
std::string Repeated(size_t bytes, const std::function<std::string(size_t index)>& piece);

/// "a12.jpg" of "a", 12 and ".jpg".
std::string Numbered(const char* before, size_t i, const char* after);

}  // namespace oraclegs
