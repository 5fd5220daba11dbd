#pragma once
// The noise of one Gaussian; the same draws as train/mcmc_noise.cpp, which explains them.

#include <cmath>

#include "oraclegs/core/rng.h"
#include "oraclegs/train/constants.h"
#include "oraclegs/train/cuda/step.h"

namespace oraclegs::cuda {

/// All but the colours of one Gaussian, or of its gradient or a moment.
struct SplatRow {
  float mean[3], log_scale[3], quat[4], logit;
};

__device__ inline SplatRow LoadRow(const GaussianRows& rows, int64_t i) {
  SplatRow row;
  for (int k = 0; k < 3; ++k) row.mean[k] = rows.means[3 * i + k];
  for (int k = 0; k < 3; ++k) row.log_scale[k] = rows.log_scales[3 * i + k];
  for (int k = 0; k < 4; ++k) row.quat[k] = rows.quats[4 * i + k];
  row.logit = rows.opacity_logits[i];
  return row;
}

__device__ inline void StoreRow(const SplatRow& row, const GaussianRows& rows, int64_t i) {
  for (int k = 0; k < 3; ++k) rows.means[3 * i + k] = row.mean[k];
  for (int k = 0; k < 3; ++k) rows.log_scales[3 * i + k] = row.log_scale[k];
  for (int k = 0; k < 4; ++k) rows.quats[4 * i + k] = row.quat[k];
  rows.opacity_logits[i] = row.logit;
}

__device__ inline float ExpClamped(float x) {
  return std::exp(x < -kExpLimit ? -kExpLimit : x > kExpLimit ? kExpLimit : x);
}

__device__ inline float Sigmoid(float x) { return 1 / (1 + ExpClamped(-x)); }

/// Standard normal numbers by Box and Muller: two from the first pair of words, one from the second.
__device__ inline void DrawNormals(const NoiseConstants& noise, uint32_t index, float* e) {
  const Philox words = Philox::Draw(noise.seed, static_cast<uint64_t>(RandomStream::kNoise),
                                    static_cast<uint64_t>(noise.iteration) << 32 | index);
  const float turn = 6.2831853f;
  const float radius0 = std::sqrt(-2 * std::log(OpenUniform(words.x[0])));
  const float radius1 = std::sqrt(-2 * std::log(OpenUniform(words.x[2])));
  const float angle0 = turn * OpenUniform(words.x[1]), angle1 = turn * OpenUniform(words.x[3]);
  e[0] = radius0 * std::cos(angle0);
  e[1] = radius0 * std::sin(angle0);
  e[2] = radius1 * std::cos(angle1);
}

/// e = Sigma e, Sigma = R S^2 R' of the raw quaternion and log scales.
__device__ inline void TimesCovariance(const SplatRow& row, float* e) {
  const float* q = row.quat;
  const float k = 2 / (q[0] * q[0] + q[1] * q[1] + q[2] * q[2] + q[3] * q[3]);  // normalises products of two components
  const float kx = k * q[1], ky = k * q[2], kz = k * q[3];
  const float xx = kx * q[1], yy = ky * q[2], zz = kz * q[3];
  const float xy = kx * q[2], xz = kx * q[3], yz = ky * q[3];
  const float wx = kx * q[0], wy = ky * q[0], wz = kz * q[0];
  const float r[3][3] = {
      {1 - (yy + zz), xy - wz, xz + wy}, {xy + wz, 1 - (xx + zz), yz - wx}, {xz - wy, yz + wx, 1 - (xx + yy)}};
  float a[3];
  for (int j = 0; j < 3; ++j) {
    const float s = ExpClamped(row.log_scale[j]);
    a[j] = s * s * (r[0][j] * e[0] + r[1][j] * e[1] + r[2][j] * e[2]);
  }
  for (int i = 0; i < 3; ++i) e[i] = r[i][0] * a[0] + r[i][1] * a[1] + r[i][2] * a[2];
}

/// Moves a Gaussian's centre: mean += Sigma (epsilon gate(opacity) strength).
__device__ inline void AddNoiseTo(const NoiseConstants& noise, uint32_t index, SplatRow* row) {
  const float gate = Sigmoid(-kGateSlope * (Sigmoid(row->logit) - kDeadOpacity));
  if (!(gate >= kMinNoiseGate)) return;
  float e[3];
  DrawNormals(noise, index, e);
  for (int k = 0; k < 3; ++k) e[k] *= gate * noise.strength;
  TimesCovariance(*row, e);
  for (int k = 0; k < 3; ++k) row->mean[k] += e[k];
}

}  // namespace oraclegs::cuda
