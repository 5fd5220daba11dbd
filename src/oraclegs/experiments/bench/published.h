#pragma once
// Scores that papers print, to stand beside ours.

#include <optional>
#include <string>
#include <vector>

namespace oraclegs {

/// Means over the scenes of a suite.
struct PublishedScore {
  std::string suite;
  int views = 0;
  std::string method;  ///< as methods.h names it, also of one that is not there
  std::string label;
  std::optional<double> psnr, ssim, lpips;  ///< dB; [0, 1]; VGG16
  std::string source;                       ///< where it is printed, with a key of docs/references.md
};

/// Those of a suite and a number of training views; none where none is known.
std::vector<PublishedScore> PublishedFor(const std::string& suite, int views);

}  // namespace oraclegs
