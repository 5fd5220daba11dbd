#pragma once
// Eigen's arithmetic on buffers of the host.

#include <Eigen/Core>
#include <algorithm>
#include <cmath>

#include "support/buffers.h"

namespace oraclegs {

/// The numbers of a buffer, to be read and written: Flat(x).setConstant(2), Flat(x).maxCoeff().
template <class T>
Eigen::Map<Eigen::Array<T, Eigen::Dynamic, 1>> Flat(const Buffer<T>& buffer) {
  return {buffer.data(), buffer.count()};
}

/// The same as a table with a row for each item of the first dimension; its columns are all other dimensions.
template <class T>
Eigen::Map<Eigen::Array<T, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>> Table(const Buffer<T>& buffer) {
  return {buffer.data(), buffer.size(0), buffer.shape().row()};
}

/// A copy of the numbers in double precision.
template <class T>
Eigen::ArrayXd Wide(const Buffer<T>& buffer) {
  return Flat(buffer).template cast<double>();
}

/// A buffer of this shape with the numbers of an Eigen expression, rounded to float.
template <class Derived>
Buffer<float> ToBuffer(const Shape& shape, const Eigen::ArrayBase<Derived>& numbers) {
  const Buffer<float> buffer = Buffer<float>::Empty(shape);
  if (numbers.size() != buffer.count()) throw ShapeError("{} numbers for {}", numbers.size(), shape.Text());
  Flat(buffer) = numbers.template cast<float>();
  return buffer;
}

/// As a buffer of doubles, for MaxAbsError and RelativeL2.
inline Buffer<double> AsBuffer(const Eigen::ArrayXd& numbers) {
  return Buffer<double>::From({numbers.size()}, {numbers.data(), static_cast<size_t>(numbers.size())});
}

/// 1 where the number exceeds the threshold, else 0.
inline Buffer<float> Above(const Buffer<float>& buffer, float threshold) {
  return ToBuffer(buffer.shape(), (Flat(buffer) > threshold).cast<float>());
}

inline bool AllFinite(const Buffer<float>& buffer) {
  return std::all_of(buffer.span().begin(), buffer.span().end(), [](float x) { return std::isfinite(x); });
}

}  // namespace oraclegs
