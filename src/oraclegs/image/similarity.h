#pragma once
// How alike two colors are: what the confidence of a proposed pixel predicts (docs/method.md#consistency-oracle).

#include <cmath>
#include <numbers>

namespace oraclegs {

/// The error of a color in [0, 1] at which the similarity is 1/e.
inline constexpr double kSimilarityScale = 0.08;

/// exp(-(error / scale)^2): 1 = equal.
template <class T>
T Similarity(T error, T scale = static_cast<T>(kSimilarityScale)) {
  return std::exp(-(error / scale) * (error / scale));
}

/// The similarity to expect where errors have this mean: those of a surface that is right now and then are many small
/// and few large ones, half-normal.
inline float ExpectedSimilarity(float mean_error) {
  const float ratio = mean_error / static_cast<float>(kSimilarityScale);
  return 1 / std::sqrt(1 + std::numbers::pi_v<float> * ratio * ratio);
}

/// The squared error of which this is the similarity.
inline float SquaredErrorOf(float similarity) {
  return -static_cast<float>(kSimilarityScale * kSimilarityScale) * std::log(similarity);
}

}  // namespace oraclegs
