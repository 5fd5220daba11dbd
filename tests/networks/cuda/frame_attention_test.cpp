#include "oraclegs/networks/cuda/kernels.h"

#include "networks/cuda/bfloat16.h"

namespace oraclegs::cuda {
namespace {

class FrameAttentionTest : public CudaTest {};

/// Input and expected output of the kernel.
struct Case {
  Halves qkv;
  Eigen::ArrayXd expected;
};

Case MakeCase(const FrameAttention& in, const Buffer<float>& numbers) {
  const Halves qkv = ToHalves(numbers);
  const int64_t width = 64;
  Eigen::ArrayXd expected(qkv.values.size() / 3);
  for (int64_t b = 0; b < in.batch; ++b) {
    for (int64_t pixel = 0; pixel < in.pixels; ++pixel) {
      for (int64_t head = 0; head < in.heads; ++head) {
        const auto token = [&](int64_t frame) { return (b * in.frames + frame) * in.pixels + pixel; };
        const auto row = [&](int64_t frame, int64_t which) {
          return qkv.values.segment(((3 * token(frame) + which) * in.heads + head) * width, width);
        };
        for (int64_t i = 0; i < in.frames; ++i) {
          Eigen::ArrayXd weights(in.frames);
          for (int64_t j = 0; j < in.frames; ++j) weights[j] = (row(i, 0) * row(j, 1)).sum() / 8;
          weights = (weights - weights.maxCoeff()).exp().eval();
          Eigen::ArrayXd sum = Eigen::ArrayXd::Zero(width);
          for (int64_t j = 0; j < in.frames; ++j) sum += weights[j] * row(j, 2);
          expected.segment((token(i) * in.heads + head) * width, width) = sum / weights.sum();
        }
      }
    }
  }
  return {qkv, expected};
}

void ExpectRight(FrameAttention in, const Case& expected) {
  const Buffer<uint16_t> out = HalvesToFill({in.batch, in.frames, in.pixels, in.heads, 64});
  in.qkv = expected.qkv.bits(), in.out = out.data();
  RunFrameAttention(in, kStream);
  EXPECT_LE(ErrorBeyondRounding(ValuesOf(out), expected.expected, 1e-5), 0) << in.frames << " frames";
}

TEST_F(FrameAttentionTest, EachPixelAttendsToItselfInAllFrames) {
  for (const FrameAttention& in : {FrameAttention{1, 1, 1, 1}, {2, 5, 21, 2}, {1, 3, 24, 3}}) {
    // Of more than unit variance, so that some weights are near one.
    const Shape shape{in.batch, in.frames, in.pixels, 3 * in.heads * 64};
    ExpectRight(in, MakeCase(in, ToBuffer(shape, 1.5f * Flat(RandomNormal(shape, 1)))));
  }
}

TEST_F(FrameAttentionTest, LargeScoresDoNotOverflow) {
  const FrameAttention in{1, 1, 3, 1};
  ExpectRight(in, MakeCase(in, Buffer<float>::Full({1, 3, 1, 3 * 64}, 40.f)));
}

}  // namespace
}  // namespace oraclegs::cuda
