#pragma once
// The networks whose weights this program can use: what each is for, where its files are, under which license.

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

namespace oraclegs {

/// Most files are published here, gated ones for accounts only.
inline constexpr std::string_view kHuggingFace = "https://huggingface.co/";

/// A file as its authors publish it.
struct PublishedFile {
  std::string url;
  std::string sha256 = {};  ///< empty where it is published nowhere: then the server's is used
  uint64_t bytes = 0;       ///< 0 = likewise
};

struct WeightsInfo {
  std::string name;          ///< as in `oraclegs models fetch NAME`
  std::string purpose;       ///< half a line
  std::string license;       ///< its name
  std::string license_page;  ///< where to read it, and, of gated files, to agree to it
  bool non_commercial = false;
  std::string restriction = {};  ///< what the license asks beside, for people; empty = nothing unusual
  bool gated = false;            ///< the host wants an account that has agreed to the license
  std::vector<PublishedFile> files;
  bool convert = true;          ///< the files have to go through ConvertWeights (convert.h)
  uint64_t download_bytes = 0;  ///< about the size of all files
  std::string parameters = {};  ///< name of the list of its tensors (parameter_list.h)
};

/// All of them, in the order of `models list`.
const std::vector<WeightsInfo>& AllWeights();

/// Throws UsageError that lists the names there are.
const WeightsInfo& WeightsNamed(const std::string& name);

}  // namespace oraclegs
