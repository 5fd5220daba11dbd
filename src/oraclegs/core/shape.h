#pragma once

#include <algorithm>
#include <array>
#include <cstdint>
#include <initializer_list>
#include <span>
#include <string>

namespace oraclegs {

/// Sizes of an array's dimensions, outermost first; at most six.
class Shape {
 public:
  static constexpr int kMaxDims = 6;

  Shape() = default;
  /// Throws ShapeError for more than kMaxDims sizes or a negative one.
  Shape(std::initializer_list<int64_t> sizes) : Shape(std::span<const int64_t>(sizes.begin(), sizes.size())) {}
  explicit Shape(std::span<const int64_t> sizes);

  int dims() const { return dims_; }
  /// Throws ShapeError unless 0 <= i < dims(), or -dims() <= i < 0 counted from the end.
  int64_t operator[](int i) const;
  /// The product of all sizes; 1 without dimensions.
  int64_t count() const;
  /// Entries of one row, an item of the first dimension.
  int64_t row() const;
  /// This shape with another first size.
  Shape WithRows(int64_t rows) const;
  const int64_t* begin() const { return sizes_.data(); }
  const int64_t* end() const { return sizes_.data() + dims_; }
  bool operator==(const Shape& other) const { return std::equal(begin(), end(), other.begin(), other.end()); }
  /// "[480, 640, 3]"
  std::string Text() const;

 private:
  std::array<int64_t, kMaxDims> sizes_{};
  int dims_ = 0;
};

}  // namespace oraclegs
