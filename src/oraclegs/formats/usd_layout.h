#pragma once
// The names of OpenUSD's schema UsdVolParticleField3DGaussianSplat that its writer and its reader share.

namespace oraclegs {

inline constexpr const char* kUsdSplat = "ParticleField3DGaussianSplat";
inline constexpr const char *kUsdPositions = "positions", *kUsdOrientations = "orientations", *kUsdScales = "scales",
                            *kUsdOpacities = "opacities", *kUsdHarmonics = "radiance:sphericalHarmonicsCoefficients",
                            *kUsdDegree = "radiance:sphericalHarmonicsDegree";
inline constexpr const char *kUsdColorSpace = "colorSpace:name", *kUsdSrgb = "srgb_rec709_scene";

}  // namespace oraclegs
