// poses_bounds.npy of two images.

#include "fuzz/dataset_folder.h"
#include "oraclegs/datasets/llff.h"

ORACLEGS_FUZZ_TARGET(llff) {
  using namespace oraclegs;
  static const fuzz::DatasetFolder folder;
  folder.Put("poses_bounds.npy", bytes);
  folder.Read(ReadLlffScene);
}
