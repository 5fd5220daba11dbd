// Any bytes as weights of PyTorch. They are read as a file, as a zip, as a pickle and, around them, as the pickle of a
// zip, whose frame a fuzzer seldom guesses.

#include "fuzz/fuzz.h"
#include "oraclegs/weights/checkpoint/pickle_heap.h"
#include "oraclegs/weights/checkpoint/state_dict.h"
#include "oraclegs/weights/checkpoint/torch_file.h"
#include "oraclegs/weights/checkpoint/zip_directory.h"
#include "weights/checkpoint/torch_bytes.h"

namespace {

using oraclegs::PickleHeap;
using oraclegs::fuzz::Try;

constexpr int64_t kMaxElements = 1 << 20;  // of a tensor that is copied: strides of zero make many of few

void ReadWeights(std::string_view bytes) {
  PickleHeap heap;
  heap.file = "f";
  const auto root = oraclegs::ReadTorchFile(bytes, &heap);
  size_t sum = 0;
  Try([&] { (void)oraclegs::FindStateDict(root, "model", heap); });
  for (const auto& [name, tensor] : oraclegs::WithoutWrapperNames(oraclegs::FindStateDict(root, "", heap))) {
    if (!tensor.shape.empty() && tensor.shape.back() > kMaxElements) continue;
    oraclegs::ForEachPiece(tensor, [&](std::string_view piece) {
      for (const char c : piece) sum += static_cast<unsigned char>(c);
    });
  }
  if (sum == ~size_t{0}) oraclegs::fuzz::Fail("a sum");  // the sum is used
}

}  // namespace

ORACLEGS_FUZZ_TARGET(checkpoint) {
  Try([&] { ReadWeights(bytes); });
  Try([&] {
    const oraclegs::ZipDirectory zip(bytes, "f");
    for (const std::string& name : zip.Names()) Try([&] { (void)zip.Content(name); });
  });
  Try([&] {
    PickleHeap heap;
    std::string_view left = bytes;
    oraclegs::ReadPickle(&left, &heap);
  });
  const std::string zip = oraclegs::torch_bytes::Zip(
      {{"a/data.pkl", std::string(bytes)}, {"a/data/0", std::string(64, 'x')}, {"a/data/1", std::string(8, 'y')}});
  Try([&] { ReadWeights(zip); });
}
