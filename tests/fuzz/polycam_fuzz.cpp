// A camera of Polycam's raw export.

#include "fuzz/dataset_folder.h"
#include "oraclegs/core/files.h"
#include "oraclegs/datasets/polycam.h"

ORACLEGS_FUZZ_TARGET(polycam) {
  using namespace oraclegs;
  static const fuzz::DatasetFolder folder;
  static const auto image = folder.Put("images/1.png", ReadFile(folder.path() / "1.png")),
                    other = folder.Put("confidence/1.png", "");
  folder.Put("cameras/1.json", bytes);
  folder.Read(ReadPolycamScene);
}
