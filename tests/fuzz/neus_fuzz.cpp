// cameras_sphere.npz: the parts of the bytes are its arrays, in a zip archive that is whole; without parts, the
// archive.

#include "fuzz/dataset_folder.h"
#include "oraclegs/datasets/neus.h"
#include "oraclegs/formats/zip_archive.h"

ORACLEGS_FUZZ_TARGET(neus) {
  using namespace oraclegs;
  static const fuzz::DatasetFolder folder;
  const auto parts = fuzz::Parts(bytes);
  std::string archive(bytes);
  if (parts.size() > 1) {
    constexpr const char* kNames[] = {"world_mat_0.npy", "world_mat_1.npy", "scale_mat_0.npy", "scale_mat_1.npy"};
    std::vector<std::pair<std::string, std::string>> members;
    for (size_t i = 0; i < parts.size() && i < std::size(kNames); ++i) members.emplace_back(kNames[i], parts[i]);
    archive = WriteZip(members);
  }
  folder.Put("cameras_sphere.npz", archive);
  folder.Read(ReadNeusScene);
}
