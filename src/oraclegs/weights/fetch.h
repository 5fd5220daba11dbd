#pragma once
// From the name of a network to its weights on this machine.

#include <filesystem>
#include <string>

#include "oraclegs/core/progress.h"
#include "oraclegs/weights/registry.h"

namespace oraclegs {

struct FetchOptions {
  bool accept_license = false;
  bool keep_published = false;

  template <class Self, class V>
  static void Visit(Self& self, V&& visit) {
    visit("accept-license", self.accept_license, "Agree to the license of the model, which `fetch` shows");
    visit("keep-published", self.keep_published, "Keep the published files after they were converted");
  }
};

/// Settings of a download that the machine adds.
struct FetchSettings {
  std::string token = {};   ///< HF_TOKEN: sent to huggingface.co or the mirror alone, never unencrypted
  std::string mirror = {};  ///< ORACLEGS_MODELS_URL: takes the place of scheme and host of every address
};
/// From the environment. Throws UsageError when a variable cannot be what it should.
FetchSettings FetchSettingsFromEnvironment();

/// One line about the license for people.
std::string LicenseText(const WeightsInfo& model);

/// The address at the mirror; the address itself without one.
std::string AtMirror(const std::string& url, const std::string& mirror);

/// Downloads the published files into WeightsFolder()/NAME and converts them where that is needed (convert.h). Names
/// and shapes of files that need no conversion are checked, with a Warning if they are not as expected. Returns the
/// weights; those that are there already are checked and never replaced. Throws UsageError without agreement to the
/// license, what Download throws, RunError when the conversion fails; the published files then stay.
std::filesystem::path FetchWeights(const WeightsInfo& model, const FetchOptions& options, const FetchSettings& settings,
                                   const Listener& listener);

}  // namespace oraclegs
