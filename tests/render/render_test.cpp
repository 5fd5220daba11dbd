#include "oraclegs/render/render.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace oraclegs {
namespace {

class NoConsumer final : public GradientConsumer {};

TEST(GradientConsumer, ThrowsOnAnotherDevice) {
  NoConsumer consumer;
  EXPECT_THAT([&] { consumer.ConsumeBlock(0, 1, {}); },
              testing::ThrowsMessage<ShapeError>(testing::HasSubstr("on a CPU")));
}

}  // namespace
}  // namespace oraclegs
