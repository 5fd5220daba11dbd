#include "oraclegs/core/shape.h"

#include "oraclegs/core/error.h"

namespace oraclegs {

Shape::Shape(std::span<const int64_t> sizes) : dims_(static_cast<int>(sizes.size())) {
  if (sizes.size() > kMaxDims)
    throw ShapeError("an array of {} dimensions, at most {} are possible", sizes.size(), kMaxDims);
  std::copy(sizes.begin(), sizes.end(), sizes_.begin());
  for (const int64_t size : sizes) {
    if (size < 0) throw ShapeError("{} has a negative size", Text());
  }
}

int64_t Shape::operator[](int i) const {
  const int at = i < 0 ? i + dims_ : i;
  if (at < 0 || at >= dims_) throw ShapeError("dimension {} of {} is asked for", i, Text());
  return sizes_[static_cast<size_t>(at)];
}

int64_t Shape::count() const {
  int64_t count = 1;
  for (const int64_t size : *this) count *= size;
  return count;
}

int64_t Shape::row() const {
  int64_t count = 1;
  for (int i = 1; i < dims_; ++i) count *= sizes_[static_cast<size_t>(i)];
  return count;
}

Shape Shape::WithRows(int64_t rows) const {
  Shape shape = *this;
  if (dims_ == 0 || rows < 0) throw ShapeError("{} cannot have {} rows", Text(), rows);
  shape.sizes_[0] = rows;
  return shape;
}

std::string Shape::Text() const { return fmt::format("[{}]", fmt::join(begin(), end(), ", ")); }

}  // namespace oraclegs
