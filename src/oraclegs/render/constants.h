#pragma once
// The constants of the rasterizer (docs/method.md#projection, #blending). Plain numbers, so that kernels of every
// device can include this file.

namespace oraclegs {

inline constexpr float kNearPlane = 0.2f;             // units of the run; nearer Gaussians are culled
inline constexpr float kLowPass = 0.3f;               // px^2 added to the covariance's diagonal
inline constexpr float kCompensationFloor = 2.5e-5f;  // under the root of the antialiasing factor
inline constexpr float kAlphaMin = 1.f / 255;         // below one 8-bit step: skipped
inline constexpr float kAlphaMax = 0.99f;             // the backward pass divides by 1 - alpha
inline constexpr float kTransmittanceEnd = 1e-4f;     // what is left cannot move an 8-bit pixel
inline constexpr float kFrustumMargin = 0.3f;         // clamp of the linearization point, in half image widths

inline constexpr float kLog2E = 1.442695040888963f;
inline constexpr float kLog2AlphaMin = -7.99435343685886f;  // log2(kAlphaMin)
inline constexpr float kLog255 = 5.541263545158426f;        // -ln(kAlphaMin)

inline constexpr int kTile = 16;  // pixels a side
inline constexpr int kTilePixels = kTile * kTile;
inline constexpr int kMaxRenderSide = 32768;  // pixels; a tile's column and row fit 16 bits, its number 32

static_assert(255 * kTransmittanceEnd < 0.5f && kAlphaMax < 1);

}  // namespace oraclegs
