#pragma once
// The container and the names of glTF that its writer and its reader share.

#include <cstdint>
#include <string>

namespace oraclegs {

inline constexpr uint32_t kGlbMagic = 0x46546C67;  // "glTF"
inline constexpr uint32_t kGlbVersion = 2;
inline constexpr uint32_t kGlbJsonChunk = 0x4E4F534A;  // "JSON"
inline constexpr uint32_t kGlbBinChunk = 0x004E4942;   // "BIN"
inline constexpr int kGlbHeader = 12, kGlbChunkHeader = 8;

inline constexpr int kGltfByte = 5120, kGltfUnsignedByte = 5121, kGltfShort = 5122, kGltfUnsignedShort = 5123,
                     kGltfFloat = 5126;

inline constexpr const char* kSplatExtension = "KHR_gaussian_splatting";
inline constexpr const char* kDisplayColors = "srgb_rec709_display";  ///< what the program's colors are
inline constexpr const char* kLinearColors = "lin_rec709_display";
inline constexpr const char* kSpzExtension = "KHR_gaussian_splatting_compression_spz_2";
inline constexpr const char* kSplatRotation = "KHR_gaussian_splatting:ROTATION";
inline constexpr const char* kSplatScale = "KHR_gaussian_splatting:SCALE";
inline constexpr const char* kSplatOpacity = "KHR_gaussian_splatting:OPACITY";
inline constexpr const char* kSplatSupport = "_SUPPORT";

/// The attribute of a coefficient of harmonics, counted over all degrees.
inline std::string HarmonicAttribute(int coefficient) {
  int degree = 0;
  while ((degree + 1) * (degree + 1) <= coefficient) ++degree;
  return "KHR_gaussian_splatting:SH_DEGREE_" + std::to_string(degree) + "_COEF_" +
         std::to_string(coefficient - degree * degree);
}

}  // namespace oraclegs
