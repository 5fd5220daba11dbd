#pragma once
// Buffers in tests: Eigen's arithmetic on them, random ones, golden numbers, and the error measures of the tests.

#include <Eigen/Core>
#include <cmath>
#include <cstring>
#include <random>
#include <string>
#include <vector>

#include "oraclegs/core/buffer.h"
#include "support/golden.h"

namespace oraclegs {

/// The numbers of a buffer on the host, to be read and written: Flat(x).setConstant(2), Flat(x).maxCoeff().
template <class T>
Eigen::Map<Eigen::Array<T, Eigen::Dynamic, 1>> Flat(const Buffer<T>& buffer) {
  return {buffer.data(), buffer.count()};
}

/// The numbers of a buffer as a table with a row for each item of the first dimension; columns are all other
/// dimensions.
template <class T>
Eigen::Map<Eigen::Array<T, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>> Table(const Buffer<T>& buffer) {
  return {buffer.data(), buffer.size(0), buffer.shape().row()};
}

/// A copy of the numbers in double precision.
inline Eigen::ArrayXd Wide(const Eigen::ArrayXd& numbers) { return numbers; }
template <class T>
Eigen::ArrayXd Wide(const Buffer<T>& buffer) {
  return Flat(buffer).template cast<double>();
}

/// A buffer of this shape with the numbers of an Eigen expression, rounded to float.
template <class Derived>
Buffer<float> ToBuffer(const Shape& shape, const Eigen::ArrayBase<Derived>& numbers) {
  const Buffer<float> buffer = Buffer<float>::Empty(shape);
  if (numbers.size() != buffer.count()) throw ShapeError("{} numbers for {}", numbers.size(), shape.Text());
  Flat(buffer) = numbers.template cast<float>().reshaped();
  return buffer;
}

/// Uniform numbers in [0, 1).
inline Buffer<float> RandomUniform(const Shape& shape, uint64_t seed) {
  std::mt19937_64 engine(seed);
  std::uniform_real_distribution<float> draw(0.f, 1.f);
  const Buffer<float> buffer = Buffer<float>::Empty(shape);
  for (float& x : buffer.span()) x = draw(engine);
  return buffer;
}

/// Standard normal numbers.
inline Buffer<float> RandomNormal(const Shape& shape, uint64_t seed) {
  std::mt19937_64 engine(seed);
  std::normal_distribution<float> draw;
  const Buffer<float> buffer = Buffer<float>::Empty(shape);
  for (float& x : buffer.span()) x = draw(engine);
  return buffer;
}

/// 1 where the number exceeds the threshold, else 0.
inline Buffer<float> Above(const Buffer<float>& buffer, float threshold) {
  const Buffer<float> mask = Buffer<float>::Empty(buffer.shape());
  Flat(mask) = (Flat(buffer) > threshold).cast<float>();
  return mask;
}

/// Whether shapes and numbers are equal; NaN equals nothing.
template <class T>
bool Equal(const Buffer<T>& a, const Buffer<T>& b) {
  return a.shape() == b.shape() && std::equal(a.span().begin(), a.span().end(), b.span().begin());
}

/// Whether shapes and bytes are equal.
template <class T>
bool SameBytes(const Buffer<T>& a, const Buffer<T>& b) {
  return a.shape() == b.shape() &&
         (a.count() == 0 || std::memcmp(a.data(), b.data(), static_cast<size_t>(a.bytes())) == 0);
}

inline bool AllFinite(const Buffer<float>& buffer) {
  return std::all_of(buffer.span().begin(), buffer.span().end(), [](float x) { return std::isfinite(x); });
}

/// The largest absolute value.
inline float MaxAbs(const Buffer<float>& buffer) { return Flat(buffer).abs().maxCoeff(); }

/// |x - ref|_2 / |ref|_2 in double, of buffers or ArrayXd.
template <class X, class Ref>
double RelativeL2(const X& x, const Ref& ref) {
  const Eigen::ArrayXd wide = Wide(x), wanted = Wide(ref);
  if (wide.size() != wanted.size()) throw ShapeError("{} numbers, expected {}", wide.size(), wanted.size());
  return (wide - wanted).matrix().norm() / wanted.matrix().norm();
}

/// max |x - ref| in double; NaN where either has one.
template <class X, class Ref>
double MaxAbsError(const X& x, const Ref& ref) {
  const Eigen::ArrayXd wide = Wide(x), wanted = Wide(ref);
  if (wide.size() != wanted.size()) throw ShapeError("{} numbers, expected {}", wide.size(), wanted.size());
  return (wide - wanted).abs().maxCoeff<Eigen::PropagateNaN>();
}

/// A stored tensor in double precision.
inline Buffer<double> GoldenDouble(const SafetensorsFile& file, const std::string& name) {
  return Buffer<double>::From(Shape(file.Get(name).shape), file.Values<double>(name));
}

/// A stored tensor as float32, for inputs.
inline Buffer<float> GoldenFloat(const SafetensorsFile& file, const std::string& name) {
  return Buffer<float>::From(Shape(file.Get(name).shape), file.Values<float>(name));
}

/// [C,H,W] as stored to [H,W,C] as used.
template <class T>
Buffer<T> Interleaved(const Buffer<T>& planes) {
  const int64_t channels = planes.size(0), pixels = planes.shape().row();
  const Buffer<T> image = Buffer<T>::Empty({planes.size(1), planes.size(2), channels});
  for (int64_t c = 0; c < channels; ++c) {
    for (int64_t i = 0; i < pixels; ++i) image[i * channels + c] = planes[c * pixels + i];
  }
  return image;
}

}  // namespace oraclegs
