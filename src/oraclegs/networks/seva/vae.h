#pragma once
// The autoencoder of Stable Diffusion 2.1: images to latents and back (docs/method.md#seva-autoencoder). The defaults
// are the published network, stabilityai/stable-diffusion-2-1-base, folder vae.

#include <filesystem>
#include <vector>

#include "oraclegs/networks/seva/vae_layers.h"

namespace oraclegs::seva {

/// Published network: image pixels along a side of a latent pixel; channels of a latent.
inline constexpr int64_t kLatentStride = 8, kLatentChannels = 4;

struct VaeConfig {
  std::vector<int64_t> channels = {128, 256, 512, 512};  ///< one entry a level; the latents are at the last one
  int64_t resnets = 2;  ///< residual blocks of an encoder level; a decoder level has one more
  int64_t latent_channels = 4;
  VaeNormShape norm;
  double latent_scale = 0.18215;  ///< scales latents to about unit variance, on which the diffusion works

  /// Image side over latent side: 8.
  int64_t downscale() const { return int64_t{1} << (channels.size() - 1); }
};

struct VaeEncoder {
  Conv conv_in;
  std::vector<VaeLevel> levels;
  VaeMiddle middle;
  GroupNorm norm_out;
  Conv conv_out, quant;
};

struct VaeDecoder {
  Conv post_quant, conv_in;
  VaeMiddle middle;
  std::vector<VaeLevel> levels;
  GroupNorm norm_out;
  Conv conv_out;
};

struct Vae {
  VaeConfig config;
  VaeEncoder encoder;
  VaeDecoder decoder;
};
/// Throws ShapeError for a configuration without levels or with groups that do not divide a level's channels.
Vae LoadVae(ParameterSource& source, const VaeConfig& config);
/// Reads a safetensors file with the official names; older names of the attention (query, key, value, proj_attn) are
/// understood. Throws InputError that lists all that does not fit.
Vae LoadVae(const std::filesystem::path& path, const VaeConfig& config = {}, torch::Device device = torch::kCPU,
            torch::ScalarType type = torch::kFloat);

/// images [B, 3, H, W] float32 RGB in [-1, 1], sides multiples of downscale() -> mean, then log-variance of the
/// latents, [B, 2 latent_channels, H / 8, W / 8] float32, unscaled. One image at a time. Throws ShapeError.
Tensor LatentMoments(const Vae& vae, const Tensor& images);

/// Mean of the latents times latent_scale: [B, latent_channels, H / 8, W / 8] float32. No sample is drawn: the model
/// was trained on means.
Tensor EncodeImages(const Vae& vae, const Tensor& images);

/// Part of the decoder at latent resolution: z [B, latent_channels, h, w], unscaled, -> [B, C, h, w]. All attention is
/// here.
Tensor DecodeMiddle(const VaeDecoder& decoder, const Tensor& z);
/// Rest of the decoder: [B, C, h, w] -> [B, 3, 8 h, 8 w].
Tensor DecodeLevels(const VaeDecoder& decoder, const Tensor& middle);

/// latents [B, latent_channels, h, w] float32 as from EncodeImages -> [B, 3, 8 h, 8 w] float32 RGB, about [-1, 1], not
/// clamped. One image at a time. Throws ShapeError.
Tensor DecodeLatents(const Vae& vae, const Tensor& latents);

/// Throws ShapeError "WHO: ..." unless latents is float32 [B >= 1, latent_channels, h >= 1, w >= 1].
void RequireLatents(const char* who, const Tensor& latents, const VaeConfig& config);

}  // namespace oraclegs::seva
