#include "oraclegs/render/render.h"

namespace oraclegs {

void GradientConsumer::ConsumeBlock(int64_t, int64_t, const GaussianRows&) {
  throw ShapeError("this consumer of gradients does not work on a CPU");
}

void GradientConsumer::ConsumeOnDevice(const cuda::GaussianBackwardInput&) {
  throw ShapeError("this consumer of gradients does not work on a GPU");
}

}  // namespace oraclegs
