#pragma once
// Stable Virtual Camera as OracleGS uses it (docs/method.md#seva): input images and target poses in, images out.

#include <filesystem>
#include <functional>
#include <string>
#include <vector>

#include "oraclegs/core/progress.h"
#include "oraclegs/networks/networks.h"
#include "oraclegs/networks/seva/memory.h"
#include "oraclegs/networks/seva/unet.h"
#include "oraclegs/scene/loaded_view.h"

namespace oraclegs::seva {

enum class Component { kEncoder, kUnet, kDecoder };

/// The four networks. Images are [1, 3, H, W] float32 RGB in [-1, 1] on the CPU.
struct NetworkSet {
  const Unet* unet = nullptr;
  std::function<Tensor(const Tensor& image)> encode = {};  ///< -> [1, 4, H / 8, W / 8] float32, scaled latent
  /// Inverse of `encode`, in tiles of `side` latent pixels.
  std::function<Tensor(const Tensor& latent, int64_t side)> decode = {};
  std::function<Tensor(const Tensor& image)> embed = {};  ///< -> [1, context width] float32
  /// Called with the component that runs next, so that the others may leave the device; may be empty.
  std::function<void(Component)> place = {};
  int64_t other_weights =
      0;  ///< bytes of encoder, decoder and image encoder that stay on the device while the UNet works
  AutoencoderMemory autoencoder = {};  ///< memory that encode and decode take
  int64_t free_bytes = 0;  ///< free memory of the UNet's device before it was loaded; 0 = asks the operating system
};

class Generator {
 public:
  /// Throws UsageError for options out of range, ShapeError when a network is missing.
  Generator(NetworkSet networks, SevaOptions options, Listener listener);

  /// See ViewGenerator::Generate; `listener` receives the steps.
  std::vector<std::vector<ImageF>> Generate(const ViewRequest& request) const;

 private:
  NetworkSet networks_;
  SevaOptions options_;
  Listener listener_;
};

/// [0, 1], channels interleaved <-> [1, 3, h, w] in [-1, 1].
Tensor ToNetworkImage(const ImageF& image);
ImageF FromNetworkImage(const Tensor& tensor);

}  // namespace oraclegs::seva
