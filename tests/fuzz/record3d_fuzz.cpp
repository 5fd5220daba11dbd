// The metadata of a capture of Record3D.

#include "fuzz/dataset_folder.h"
#include "oraclegs/core/files.h"
#include "oraclegs/datasets/record3d.h"

ORACLEGS_FUZZ_TARGET(record3d) {
  using namespace oraclegs;
  static const fuzz::DatasetFolder folder;
  static const auto image = folder.Put("rgbd/1.jpg", ReadFile(folder.path() / "1.png"));
  folder.Put("metadata.json", bytes);
  folder.Read(ReadRecord3dScene);
}
