#include "oraclegs/core/shape.h"

#include "oraclegs/core/error.h"

namespace oraclegs {
namespace {

/// Unsigned, so that it is defined for every file: an array without entries may have sizes whose product is no number.
int64_t Product(const int64_t* begin, const int64_t* end) {
  uint64_t product = 1;
  for (const int64_t* size = begin; size != end; ++size) product *= static_cast<uint64_t>(*size);
  return static_cast<int64_t>(product);
}

}  // namespace

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

int64_t Shape::count() const { return Product(begin(), end()); }

int64_t Shape::row() const { return dims_ == 0 ? 1 : Product(begin() + 1, end()); }

Shape Shape::WithRows(int64_t rows) const {
  Shape shape = *this;
  if (dims_ == 0 || rows < 0) throw ShapeError("{} cannot have {} rows", Text(), rows);
  shape.sizes_[0] = rows;
  return shape;
}

std::string Shape::Text() const { return fmt::format("[{}]", fmt::join(begin(), end(), ", ")); }

}  // namespace oraclegs
