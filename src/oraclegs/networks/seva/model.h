#pragma once
// The four networks of SEVA out of their files, ready for the generator.

#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include "oraclegs/networks/seva/generator.h"

namespace oraclegs::seva {

Placement PlaceOn(torch::Device device, Precision precision);

/// Owns the networks. On the CPU the files are mapped and nothing is copied in float32. On another device the UNet
/// stays; the encoders and the decoder come when they are needed and leave before the UNet works.
class Model {
 public:
  /// Files of other sizes than the published ones say so in their metadata, as tests/golden/seva_unet_tiny,
  /// seva_vae_tiny and openclip_visual_tiny do. Throws InputError that lists all that does not fit.
  Model(const SevaFiles& files, const Placement& placement);
  ~Model();

  /// Valid as long as this lives.
  NetworkSet networks() const;

 private:
  struct State;
  std::unique_ptr<State> state_;
};

/// The generator as the program sees it. Throws InputError as Model does, UsageError for options out of range.
std::unique_ptr<ViewGenerator> LoadViewGenerator(const ViewGeneratorRequest& request);

}  // namespace oraclegs::seva
