#pragma once
// Quality of the oracle: confidence against known errors, pixel by pixel.

#include <cstdint>
#include <nlohmann/json_fwd.hpp>
#include <vector>

namespace oraclegs {

inline constexpr float kLargeError = 0.1f;  ///< error above which a pixel of a proposal is plainly wrong
inline constexpr int kReliabilityBins = 10;
inline constexpr double kSmallBin = 0.005;  ///< share of the pixels below which a bin is too small to judge

/// The pixels whose confidence lies in [from, to), the last bin's in [from, 1].
struct ReliabilityBin {
  double from = 0, to = 0;
  double confidence = 0;  ///< mean
  double error = 0;       ///< mean
  double similarity = 0;  ///< mean Similarity(error), what a calibrated confidence equals
  double share = 0;       ///< fraction of all pixels
};

/// Sparsification: the least confident pixels are removed one after the other, and the mean error of the rest is taken,
/// from all pixels down to the last; pixels of equal confidence leave in random order, and the expected value is taken.
/// Areas are between that curve and that of the ideal order, over the removed fraction, divided by the mean error.
struct OracleQuality {
  int64_t pixels = 0;
  double mean_error = 0;
  double ause = 0;         ///< 0 = the confidence orders pixels as their errors do
  double ause_random = 0;  ///< area for pixels removed at random, as with a constant confidence
  double ause_ratio = 0;   ///< ause / ause_random, NaN when all errors are equal
  double spearman = 0;  ///< rank correlation of confidence and -error, ties by their mean rank; 0 when one is constant
  double median_error = 0;        ///< for an even count the lower of the two in the middle
  double auroc_above_median = 0;  ///< low confidence as a sign of error > median_error; NaN when none or all are
  double auroc_large_error = 0;  ///< AUROC of low confidence as a sign of error > kLargeError; NaN when none or all are
  std::vector<ReliabilityBin> reliability;  ///< kReliabilityBins of equal width without the empty ones, ascending
  /// Expected calibration error: |mean confidence - mean similarity| of the bins, averaged by their shares.
  double calibration_error = 0;
  /// Whether mean error falls from bin to bin, after bins of less than kSmallBin of the pixels are joined with the
  /// neighbor of nearer mean confidence. False for a single bin, which shows nothing.
  bool monotone = false;

  /// Measures the quality. error: >= 0, ColorError (image/color_error.h) of the proposal; confidence in [0, 1]; one
  /// number per pixel of all proposals together. Throws ShapeError when they are not of one length, empty or out of
  /// range.
  static OracleQuality FromPixels(const std::vector<float>& error, const std::vector<float>& confidence);
};

/// The fields by name as JSON, the bins as a list of objects; NaN becomes null.
nlohmann::json ToJson(const OracleQuality& quality);

}  // namespace oraclegs
