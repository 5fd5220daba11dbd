#pragma once
// A SEVA of a few thousand numbers: random UNet, and stand-ins for the other networks that keep what matters of them.

#include "networks/fixtures.h"
#include "oraclegs/networks/seva/generator.h"

namespace oraclegs::seva {

inline constexpr int64_t kTinyContext = 12;

inline UnetConfig TinyUnetConfig() {
  UnetConfig config;
  config.channels = 8;
  config.channel_mult = {1, 2};
  config.res_blocks = 1;
  config.attention_downscales = {2, 1};
  config.head_width = 4;
  config.transformer_depth = {1, 1};
  config.context_width = kTinyContext;
  config.groups = 4;
  config.joint = {"middle_ds2", "output_ds2"};
  return config;
}

inline Unet TinyUnet() {
  RandomParameters source(11);
  return LoadUnet(source, TinyUnetConfig());
}

/// The mean of 8 x 8 pixels as three channels of the latent, and back; the embedding is the mean color.
inline NetworkSet TinyNetworkSet(const Unet& unet) {
  NetworkSet networks;
  networks.unet = &unet;
  networks.encode = [](const Tensor& image) {
    const Tensor mean = at::avg_pool2d(image, {8, 8});
    return at::cat({mean, mean.slice(1, 0, 1)}, 1);
  };
  networks.decode = [](const Tensor& latent, int64_t) {
    return at::upsample_nearest2d(at::tanh(latent.slice(1, 0, 3)), {latent.size(2) * 8, latent.size(3) * 8});
  };
  networks.embed = [](const Tensor& image) { return image.mean({2, 3}).repeat({1, kTinyContext / 3}); };
  networks.free_bytes = int64_t{1} << 40;
  return networks;
}

}  // namespace oraclegs::seva
