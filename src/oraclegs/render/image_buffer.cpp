#include "oraclegs/render/image_buffer.h"

#include <algorithm>

namespace oraclegs {

const Buffer<float>& ImageBuffer::Get(const Shape& shape) {
  const auto found =
      std::find_if(views_.begin(), views_.end(), [&](const Buffer<float>& view) { return view.shape() == shape; });
  if (found != views_.end()) return *found;
  if (!storage_.defined() || storage_.count() < shape.count()) {
    views_.clear();  // they would keep the old storage alive
    storage_ = {};   // first, so that both are never held at once
    storage_ = Buffer<float>::Empty({shape.count()}, device_, purpose_);
  }
  return views_.emplace_back(storage_.Head(shape));
}

}  // namespace oraclegs
