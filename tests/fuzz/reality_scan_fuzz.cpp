// A CSV of RealityScan.

#include "fuzz/dataset_folder.h"
#include "oraclegs/datasets/reality_scan.h"

ORACLEGS_FUZZ_TARGET(reality_scan) {
  using namespace oraclegs;
  static const fuzz::DatasetFolder folder;
  folder.Put("cameras.csv", bytes);
  if (IsRealityScanScene(folder.path())) folder.Read(ReadRealityScanScene);
}
