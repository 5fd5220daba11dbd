#include "oraclegs/weights/checkpoint/stored_tensor.h"

#include <algorithm>
#include <cstring>
#include <optional>

#include "oraclegs/core/error.h"
#include "oraclegs/core/text.h"

namespace oraclegs {
namespace {

constexpr size_t kPieceBytes = size_t{1} << 24;

/// How many elements a tensor has, and the index of the last one behind its first; nothing when a sum overflows.
struct Span {
  int64_t numel = 1, last = 0;
};
std::optional<Span> SpanOf(const std::vector<int64_t>& shape, const std::vector<int64_t>& strides) {
  if (std::find(shape.begin(), shape.end(), 0) != shape.end()) return Span{0, 0};
  Span span;
  for (size_t i = 0; i < shape.size(); ++i) {
    int64_t reach = 0;
    if (__builtin_mul_overflow(span.numel, shape[i], &span.numel) ||
        __builtin_mul_overflow(shape[i] - 1, strides[i], &reach) ||
        __builtin_add_overflow(span.last, reach, &span.last))
      return std::nullopt;
  }
  return span;
}

/// Steps through the rows, the last dimension, of a tensor that has at least one element.
class RowCursor {
 public:
  explicit RowCursor(const StoredTensor& tensor) : tensor_(tensor), at_(tensor.shape.size(), 0) {}

  int64_t offset() const { return offset_; }
  /// False when there is no further row.
  bool Next() {
    for (size_t i = at_.size() - 1; i-- > 0;) {
      offset_ += tensor_.strides[i];
      if (++at_[i] < tensor_.shape[i]) return true;
      offset_ -= tensor_.strides[i] * tensor_.shape[i];
      at_[i] = 0;
    }
    return false;
  }

 private:
  const StoredTensor& tensor_;
  std::vector<int64_t> at_;
  int64_t offset_ = 0;  // elements
};

/// Then the product of the other sizes may be larger than any number.
bool HoldsNothing(const std::vector<int64_t>& shape) { return std::find(shape.begin(), shape.end(), 0) != shape.end(); }

}  // namespace

bool StoredTensor::IsContiguous() const {
  if (HoldsNothing(shape)) return true;
  int64_t expected = 1;
  for (size_t i = shape.size(); i-- > 0;) {
    if (shape[i] != 1 && strides[i] != expected) return false;
    expected *= shape[i];
  }
  return true;
}

std::vector<int64_t> ContiguousStrides(const std::vector<int64_t>& shape) {
  std::vector<int64_t> strides(shape.size(), 1);
  if (HoldsNothing(shape)) return strides;
  for (size_t i = shape.size(); i-- > 1;) strides[i - 1] = strides[i] * shape[i];
  return strides;
}

StoredTensor StoredTensorOf(const PickleTensor& tensor, const std::string& name, const PickleHeap& heap) {
  StoredTensor stored{tensor.element.name, tensor.element.bytes, tensor.shape, tensor.strides, {}};
  const auto span = SpanOf(tensor.shape, tensor.strides);
  if (span && span->numel == 0) return stored;
  std::string_view bytes;
  if (tensor.slice != PickleTensor::kNoSlice) {
    const PickleStorageSlice& slice = heap.slices[tensor.slice];
    const PickleStorage& storage = heap.storages[slice.storage];
    const auto width = static_cast<uint64_t>(storage.element.bytes);
    bytes =
        storage.bytes.substr(static_cast<uint64_t>(slice.offset) * width, static_cast<uint64_t>(slice.numel) * width);
  }
  const auto held = static_cast<int64_t>(bytes.size()) / tensor.element.bytes;
  const bool fits = span && span->numel <= held && tensor.offset < held && span->last < held - tensor.offset;
  if (!fits) {
    throw InputError("{}: tensor '{}' reaches beyond its numbers; get the file again", heap.file, Printable(name));
  }
  stored.bytes = bytes.substr(static_cast<size_t>(tensor.offset * tensor.element.bytes),
                              static_cast<size_t>((span->last + 1) * tensor.element.bytes));
  return stored;
}

void ForEachPiece(const StoredTensor& tensor, FunctionRef<void(std::string_view)> consume) {
  if (tensor.IsContiguous()) {
    for (std::string_view rest = tensor.bytes; !rest.empty();) {
      consume(rest.substr(0, kPieceBytes));
      rest.remove_prefix(std::min(rest.size(), kPieceBytes));
    }
    return;
  }
  const auto width = static_cast<size_t>(tensor.element_bytes);
  const int64_t length = tensor.shape.back(), stride = tensor.strides.back();
  std::string piece;
  RowCursor row(tensor);
  do {
    const char* from = tensor.bytes.data() + static_cast<size_t>(row.offset()) * width;
    for (int64_t i = 0; i < length; ++i, from += static_cast<size_t>(stride) * width) {
      piece.append(from, width);
      if (piece.size() + width <= kPieceBytes) continue;
      consume(piece);
      piece.clear();
    }
  } while (row.Next());
  if (!piece.empty()) consume(piece);
}

}  // namespace oraclegs
