#pragma once
// Quality of the oracle by regions. Errors of single pixels are mostly chance; means over blocks are not
// (docs/method.md#oracle-quality).

#include <cstdint>
#include <nlohmann/json_fwd.hpp>
#include <vector>

namespace oraclegs {

inline constexpr int kBlockSide = 8;              ///< pixels
inline constexpr float kLargeBlockError = 0.05f;  ///< RMS error above which a block is plainly wrong

/// Error and confidence of one image's pixels, row by row.
struct ErrorMap {
  int width = 0, height = 0;
  std::vector<float> error;       ///< ColorError (image/color_error.h)
  std::vector<float> confidence;  ///< [0, 1]
  std::vector<bool> counts;       ///< false = masked out
};

struct BlockQuality {
  int64_t blocks = 0;
  double spearman = 0;           ///< mean confidence against -mean error, mean rank for ties; 0 when one is constant
  double auroc_large_error = 0;  ///< low mean confidence as a sign of an RMS error > kLargeBlockError, or NaN
};

/// Collects blocks of kBlockSide x kBlockSide pixels on the grid from the top left corner. A block is left out when
/// fewer than half of its pixels are unmasked and inside the image.
class BlockSamples {
 public:
  /// Adds an image's blocks. Throws ShapeError unless all lists are width * height long.
  void Add(const ErrorMap& map);
  /// Quality over the blocks of all images.
  BlockQuality Quality() const;

 private:
  std::vector<float> mean_error_, rms_error_, confidence_;
};

/// The fields by name as JSON; NaN becomes null.
nlohmann::json ToJson(const BlockQuality& quality);

}  // namespace oraclegs
