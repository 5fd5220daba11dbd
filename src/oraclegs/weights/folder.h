#pragma once
// Where the weights of a model are on this machine.

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

namespace oraclegs {

/// $ORACLEGS_MODELS, else ~/.cache/oraclegs. Throws UsageError when neither it nor HOME is set.
std::filesystem::path ModelsFolder();

/// The file that `models fetch` leaves: ModelsFolder()/NAME/model.safetensors.
std::filesystem::path FetchedFile(const std::string& name);

/// The weights of a model, if they are here: FetchedFile, ModelsFolder()/NAME/model.safetensors.index.json (which
/// stands for its parts) or ModelsFolder()/NAME.safetensors. Throws UsageError for a name that does not exist.
std::optional<std::filesystem::path> LocateModel(const std::string& name);

/// The same, for a stage that needs them. Throws InputError that names the command which brings them.
std::filesystem::path FindModel(const std::string& name);

/// The first of several models that will do whose weights are here, and its name. Throws InputError as FindModel does,
/// for the first name.
struct FoundModel {
  std::string name;
  std::filesystem::path weights;
};
FoundModel FindFirstModel(const std::vector<std::string>& names);

}  // namespace oraclegs
