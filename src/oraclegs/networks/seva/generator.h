#pragma once
// Stable Virtual Camera as OracleGS uses it (docs/method.md#seva): photographs and target poses in, pictures out.

#include <filesystem>
#include <functional>
#include <string>
#include <vector>

#include "oraclegs/core/progress.h"
#include "oraclegs/networks/seva/memory.h"
#include "oraclegs/networks/seva/options.h"
#include "oraclegs/networks/seva/unet.h"
#include "oraclegs/scene/loaded_view.h"

namespace oraclegs {

enum class SevaPart { kEncoder, kUnet, kDecoder };

/// The four networks. Pictures are [1, 3, H, W] float32 RGB in [-1, 1] on the CPU.
struct SevaNetworks {
  const SevaUnet* unet = nullptr;
  std::function<Tensor(const Tensor& picture)> encode = {};  ///< -> [1, 4, H / 8, W / 8] float32, scaled latent
  /// The reverse, in tiles of `side` latent pixels.
  std::function<Tensor(const Tensor& latent, int64_t side)> decode = {};
  std::function<Tensor(const Tensor& picture)> embed = {};  ///< -> [1, context width] float32
  /// Told which part works next, so that the others may leave the device; may be empty.
  std::function<void(SevaPart)> place = {};
  int64_t other_weights = 0;        ///< bytes of encoder, decoder and image encoder that stay while the UNet works
  SevaPictureMemory pictures = {};  ///< of encode and decode
  int64_t free_bytes = 0;           ///< of the UNet's device before it came; 0 = asks the operating system
};

struct SevaRequest {
  const std::vector<LoadedView>* photographs = nullptr;  ///< at least one
  std::vector<Camera> targets;
  std::filesystem::path workspace = {};  ///< finished chunks are kept here; empty: nowhere
  std::string key = {};  ///< stands for photographs, targets and weights: chunks of another key are not used again
};

class SevaGenerator {
 public:
  /// Throws UsageError for options out of range, ShapeError when a network is missing.
  SevaGenerator(SevaNetworks networks, SevaOptions options, Listener listener);

  /// Of each target options.candidates pictures of its camera's size, RGB in [0, 1]; the whole frame of the camera is
  /// generated, so its pose and lens are exact. The same for a seed, whether the work was interrupted or not; only
  /// decoding in tiles, where memory is short, gives others, with a warning. Polls for interrupts between steps;
  /// `listener` hears StepDone{"propose"} after each. Throws RunError when memory does
  /// not suffice (before the first step), UsageError for options that do not fit the photographs, InputError for
  /// photographs of different working sizes.
  std::vector<std::vector<ImageF>> Generate(const SevaRequest& request) const;

 private:
  SevaNetworks networks_;
  SevaOptions options_;
  Listener listener_;
};

/// [0, 1], channels interleaved <-> [1, 3, h, w] in [-1, 1].
Tensor ToSevaPicture(const ImageF& image);
ImageF FromSevaPicture(const Tensor& picture);

}  // namespace oraclegs
