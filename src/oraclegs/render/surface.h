#pragma once
// The surface that a render shows: its depth and normals.

#include <Eigen/Core>
#include <vector>

#include "oraclegs/camera/camera.h"
#include "oraclegs/render/render.h"

namespace oraclegs {

struct RenderedSurface {
  Camera camera;
  std::vector<float> inv_depth;          ///< [H*W] 1/z in 1/scene units; 0 where the render is too transparent
  std::vector<Eigen::Vector3f> normals;  ///< [H*W] unit, camera frame, toward the camera; zero where unknown
};

inline constexpr float kMinSurfaceAlpha = 0.5f;  ///< less opaque pixels show no surface

/// Depth and normals of a render. Inverse depth is the render's divided by its alpha. Normals are those of the plane
/// through the neighbors at most `reach` pixels away on each side; at an edge of depth, those of the flatter side.
/// Buffers of a GPU are copied.
RenderedSurface SurfaceOf(const RenderOutput& render, const Camera& camera, int reach = 1);

}  // namespace oraclegs
