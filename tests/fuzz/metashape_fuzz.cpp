// cameras.xml of Metashape.

#include "fuzz/dataset_folder.h"
#include "oraclegs/datasets/metashape.h"

ORACLEGS_FUZZ_TARGET(metashape) {
  using namespace oraclegs;
  static const fuzz::DatasetFolder folder;
  folder.Put("cameras.xml", bytes);
  if (IsMetashapeScene(folder.path())) folder.Read(ReadMetashapeScene);
}
