// bundle.out and list.txt, parts of the bytes.

#include "fuzz/dataset_folder.h"
#include "oraclegs/datasets/bundler.h"

ORACLEGS_FUZZ_TARGET(bundler) {
  using namespace oraclegs;
  static const fuzz::DatasetFolder folder;
  const auto parts = fuzz::Parts(bytes);
  folder.Put("bundle.out", fuzz::PartAt(parts, 0));
  folder.Put("list.txt", fuzz::PartAt(parts, 1));
  folder.Read(ReadBundlerScene);
}
