#pragma once
// How alike two colors are: what the confidence of a proposed pixel predicts (docs/method.md#consistency-oracle).

#include <cmath>

namespace oraclegs {

/// The error of a color in [0, 1] (RMS or mean over the channels) at which the similarity is 1/e.
inline constexpr double kSimilarityScale = 0.08;

/// exp(-(error / scale)^2): 1 = equal.
template <class T>
T Similarity(T error, T scale = static_cast<T>(kSimilarityScale)) {
  return std::exp(-(error / scale) * (error / scale));
}

/// The squared error of which this is the similarity.
inline float SquaredErrorOf(float similarity) {
  return -static_cast<float>(kSimilarityScale * kSimilarityScale) * std::log(similarity);
}

}  // namespace oraclegs
