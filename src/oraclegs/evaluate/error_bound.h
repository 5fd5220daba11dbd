#pragma once
// Bounds that most errors stay below, from photos that a model has not seen (docs/method.md#error-bound).

#include <array>
#include <cstdint>
#include <nlohmann/json_fwd.hpp>
#include <vector>

namespace oraclegs {

inline constexpr int kCertaintyClasses = 3;
/// Expected error from which on a pixel is of the next class: what is hardly seen, and what is plainly wrong.
inline constexpr std::array<double, kCertaintyClasses - 1> kClassFrom = {0.03, 0.1};
inline constexpr double kBoundShare = 0.9;  ///< of a class's pixels, whose errors stay below its bound

/// Pixels of one image: their errors and those to expect (Uncertainty::At), lists of one length.
struct ExpectedErrors {
  std::vector<float> error, expected;
};

/// Bounds of the classes of pixels, the surest first.
struct ErrorBound {
  std::array<double, kCertaintyClasses> below = {};  ///< NaN where fewer than kMinBoundPhotos have pixels of the class
  int photos = 0;                                    ///< that the bounds are from
};

inline constexpr int kMinBoundPhotos = 3;

/// Bounds from photos that the models that rendered them have not seen. Photos, not pixels, can be exchanged for each
/// other, so each weighs the same in a class, by however many pixels [Dunn 2023].
ErrorBound BoundFrom(const std::vector<ExpectedErrors>& photos);

/// How a bound holds for pixels of known error.
struct BoundCheck {
  std::array<double, kCertaintyClasses> share = {};    ///< of the pixels
  std::array<double, kCertaintyClasses> covered = {};  ///< of the class: the errors below its bound; NaN if unknown
};

/// The check at the images, each pixel weighing the same.
BoundCheck CheckBound(const ErrorBound& bound, const std::vector<ExpectedErrors>& images);

/// {"photos", "share": kBoundShare, "classes": [{"from", "to", "below"}]}, with "pixels" and "covered" of each class
/// where `check` is known; NaN becomes null.
nlohmann::json ToJson(const ErrorBound& bound, const BoundCheck* check);

}  // namespace oraclegs
