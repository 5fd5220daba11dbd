#include "oraclegs/render/image_buffer.h"

#include <algorithm>
#include <functional>
#include <numeric>

namespace oraclegs {

const Buffer<float>& ImageBuffer::Get(std::initializer_list<int64_t> shape) {
  const auto found = std::find_if(views_.begin(), views_.end(), [&](const Buffer<float>& view) {
    return std::equal(shape.begin(), shape.end(), view.shape().begin(), view.shape().end());
  });
  if (found != views_.end()) return *found;
  const int64_t count = std::accumulate(shape.begin(), shape.end(), int64_t{1}, std::multiplies<>());
  if (!storage_.defined() || storage_.count() < count) {
    views_.clear();  // they would keep the old storage alive
    storage_ = torch::empty({count}, torch::dtype(torch::kFloat).device(device_));
  }
  return views_.emplace_back(storage_.narrow(0, 0, count).view(shape));
}

}  // namespace oraclegs
