#pragma once
// The four networks of SEVA, loaded from their files for the generator.

#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include "oraclegs/networks/seva/generator.h"

namespace oraclegs::seva {

Placement PlaceOn(torch::Device device, Precision precision);

/// Owns the networks. On the CPU the files are mapped and float32 is not copied. On another device the UNet stays; the
/// encoders and the decoder are loaded when needed and freed before the UNet works.
class Model {
 public:
  /// Loads the networks. Files of other sizes than the published ones hold their sizes in their metadata, as
  /// tests/golden/seva_unet_tiny, seva_vae_tiny and openclip_visual_tiny do. Throws InputError that lists all that does
  /// not fit.
  Model(const SevaFiles& files, const Placement& placement);
  ~Model();

  /// Valid while this object lives.
  NetworkSet networks() const;

 private:
  struct State;
  std::unique_ptr<State> state_;
};

/// Generator behind the program's interface. Throws InputError as Model does, UsageError for options out of range.
std::unique_ptr<ViewGenerator> LoadViewGenerator(const ViewGeneratorRequest& request);

/// Networks::RequireMemoryToGenerate. Throws InputError for files that are no weights, too.
void RequireMemory(const ViewGeneratorRequest& request, Size photo);

}  // namespace oraclegs::seva
