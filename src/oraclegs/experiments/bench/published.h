#pragma once
// Scores that papers print, for comparison with ours.

#include <optional>
#include <string>
#include <vector>

namespace oraclegs {

/// Means over the scenes of a suite.
struct PublishedScore {
  std::string suite;
  int views = 0;
  std::string method;  ///< as in methods.h; may be a method that is not there
  std::string label;
  std::optional<double> psnr, ssim, lpips;  ///< dB; [0, 1]; VGG16
  std::string source;                       ///< paper and table, with a key of docs/references.md
};

/// Scores for a suite and a number of training views; empty where none is known.
std::vector<PublishedScore> PublishedFor(const std::string& suite, int views);

}  // namespace oraclegs
