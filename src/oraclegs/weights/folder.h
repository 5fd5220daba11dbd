#pragma once
// Where the weights of a network are on this machine.

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

namespace oraclegs {

/// $ORACLEGS_MODELS, else ~/.cache/oraclegs. Throws UsageError when neither it nor HOME is set.
std::filesystem::path WeightsFolder();

/// The file that `models fetch` leaves: WeightsFolder()/NAME/model.safetensors.
std::filesystem::path FetchedFile(const std::string& name);

/// The weights of a network, if they are here: FetchedFile, WeightsFolder()/NAME/model.safetensors.index.json (which
/// stands for its parts) or WeightsFolder()/NAME.safetensors. Throws UsageError for a name that does not exist.
std::optional<std::filesystem::path> LocateWeights(const std::string& name);

/// The weights of a network for a stage that needs them, as LocateWeights finds them. Throws InputError that names the
/// command which brings them.
std::filesystem::path RequireWeights(const std::string& name);

/// The first of several alternatives whose weights are here, and its name. Throws InputError as RequireWeights does,
/// for the first name.
struct FoundWeights {
  std::string name;
  std::filesystem::path weights;
};
FoundWeights RequireFirstWeights(const std::vector<std::string>& names);

}  // namespace oraclegs
