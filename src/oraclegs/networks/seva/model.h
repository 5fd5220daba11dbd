#pragma once
// The four networks of SEVA out of their files, ready for the generator.

#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include "oraclegs/networks/seva/generator.h"

namespace oraclegs {

struct SevaFiles {
  std::vector<std::filesystem::path> unet;
  std::filesystem::path vae, clip;
};

/// float32, bfloat16 or float16, the words of --seva-precision. Throws UsageError for another.
torch::ScalarType SevaPrecision(const std::string& word);

/// Owns the networks. On the CPU the files are mapped and nothing is copied in float32. On another device the UNet
/// stays; the encoders and the decoder come when they are needed and leave before the UNet works.
class SevaModel {
 public:
  /// Files of other sizes than the published ones say so in their metadata, as tests/golden/seva_unet_tiny,
  /// seva_vae_tiny and openclip_visual_tiny do. Throws InputError that lists all that does not fit.
  SevaModel(const SevaFiles& files, const SevaPlacement& placement);
  ~SevaModel();

  /// Valid as long as this lives.
  SevaNetworks networks() const;

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace oraclegs
