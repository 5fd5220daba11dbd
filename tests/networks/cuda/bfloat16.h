#pragma once
// bfloat16 numbers as their bits, for tests of the networks' kernels.

#include <cstring>

#include "oraclegs/core/bfloat16.h"
#include "oraclegs/core/cuda/device_array.h"
#include "support/buffers.h"
#include "support/device_buffers.h"

namespace oraclegs {

/// Relative error of rounding to the nearest bfloat16.
inline constexpr double kBfloat16Error = 1.0 / 256;

/// Truncates to bfloat16, since rounding is what the kernels are tested for.
inline uint16_t CutToBfloat16(float x) {
  uint32_t bits = 0;
  std::memcpy(&bits, &x, sizeof bits);
  return static_cast<uint16_t>(bits >> 16);
}
/// Numbers that bfloat16 holds exactly, and their bits where kernels find them.
struct Halves {
  Eigen::ArrayXd values;
  Buffer<uint16_t> device;

  const uint16_t* bits() const { return device.data(); }
};
inline Halves ToHalves(const Buffer<float>& numbers) {
  const Buffer<uint16_t> bits = Buffer<uint16_t>::Empty(numbers.shape());
  Eigen::ArrayXd values(numbers.count());
  for (int64_t i = 0; i < numbers.count(); ++i) {
    bits.data()[i] = CutToBfloat16(numbers.data()[i]);
    values[i] = static_cast<double>(FromBfloat16(bits.data()[i]));
  }
  return {values, OnTestDevice(bits)};
}
inline Halves RandomHalves(const Shape& shape, uint64_t seed) { return ToHalves(RandomNormal(shape, seed)); }

/// Memory for results, filled with numbers that no test expects.
inline Buffer<uint16_t> HalvesToFill(const Shape& shape) {
  return OnTestDevice(Buffer<uint16_t>::Full(shape, CutToBfloat16(1e30f)));
}
inline Eigen::ArrayXd ValuesOf(const Buffer<uint16_t>& device) {
  const Buffer<uint16_t> bits = OnHost(device);
  Eigen::ArrayXd values(bits.count());
  for (int64_t i = 0; i < bits.count(); ++i) values[i] = static_cast<double>(FromBfloat16(bits.data()[i]));
  return values;
}

/// The largest difference beyond the error of rounding `expected`, and beyond `absolute`.
inline double ErrorBeyondRounding(const Eigen::ArrayXd& actual, const Eigen::ArrayXd& expected, double absolute) {
  return ((actual - expected).abs() - kBfloat16Error * expected.abs() - absolute).maxCoeff();
}

}  // namespace oraclegs
