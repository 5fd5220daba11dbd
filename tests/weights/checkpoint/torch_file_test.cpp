#include "oraclegs/weights/checkpoint/torch_file.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "oraclegs/core/error.h"
#include "support/errors.h"
#include "torch_bytes.h"

namespace oraclegs {
namespace {

using testing::AnyOf;
using testing::HasSubstr;
using testing::StartsWith;
using namespace torch_bytes;  // NOLINT: files and pieces of pickles

const std::string kRoot = Dict({{"a", Vector("0", 3)}, {"b", Vector("1", 2)}});
const std::map<std::string, std::string> kStorages = {{"0", Floats({1, 2, 3})}, {"1", Floats({4, 5})}};

std::string ErrorOfReading(const std::string& file) {
  return MessageOf<InputError>([&] {
    PickleHeap heap;
    heap.file = "f.pt";
    ReadTorchFile(file, &heap);
  });
}

TEST(ReadTorchFile, FindsTheBytesOfStorages) {
  for (const std::string& file : {ZipFile(kRoot, kStorages), LegacyFile(kRoot, kStorages)}) {
    EXPECT_TRUE(LooksLikeTorchFile(file));
    PickleHeap heap;
    const PickleValue root = ReadTorchFile(file, &heap);
    EXPECT_EQ(root.kind, PickleKind::kDict);
    for (const PickleStorage& storage : heap.storages) EXPECT_EQ(storage.bytes, kStorages.at(storage.key));
    EXPECT_EQ(heap.storages.size(), 2u);
  }
  EXPECT_FALSE(LooksLikeTorchFile(""));
  EXPECT_FALSE(LooksLikeTorchFile("<html>"));
}

TEST(ReadTorchFile, RefusesTruncatedFiles) {
  for (const std::string& file : {ZipFile(kRoot, kStorages), LegacyFile(kRoot, kStorages)}) {
    for (size_t size = 4; size < file.size(); ++size) {
      EXPECT_THAT(ErrorOfReading(file.substr(0, size)), StartsWith("f.pt: ")) << size;
    }
  }
}

TEST(ReadTorchFile, RefusesStoragesThatAreTooShort) {
  EXPECT_EQ(ErrorOfReading(ZipFile(kRoot, {{"0", Floats({1, 2})}, {"1", Floats({4, 5})}})),
            "f.pt: storage '0' is cut off; get the file again");
  EXPECT_EQ(ErrorOfReading(ZipFile(kRoot, {{"0", Floats({1, 2, 3})}})),
            "f.pt: lacks its part 'archive/data/1'; the file is incomplete, get it again");
  EXPECT_EQ(ErrorOfReading(LegacyFile(kRoot, {{"0", Floats({1, 2, 3})}, {"1", Floats({4})}})),
            "f.pt: is cut off; get it again");
  EXPECT_THAT(ErrorOfReading(LegacyFile(kRoot, {{"0", Floats({1, 2, 3})}})), HasSubstr("are not those of its tensors"));
  EXPECT_THAT(ErrorOfReading(LegacyFile(kRoot, {{"0", Floats({1, 2, 3})}, {"2", Floats({4, 5})}})),
              HasSubstr("are not those of its tensors"));
}

TEST(ReadTorchFile, RefusesForeignFiles) {
  EXPECT_THAT(ErrorOfReading(Zip({{"photos/1.jpg", "x"}})), HasSubstr("is a zip, but no checkpoint of PyTorch"));
  EXPECT_THAT(ErrorOfReading(Zip({{"a/data.pkl", Pickle("N")}, {"b/data.pkl", Pickle("N")}})),
              HasSubstr("is a zip, but no checkpoint of PyTorch"));
  EXPECT_THAT(ErrorOfReading(Zip({{"net/model.json", "{}"}})),
              HasSubstr("TorchScript archive of a PyTorch before 1.4"));
  EXPECT_THAT(ErrorOfReading(Zip({{"a/data.pkl", Pickle("N")}, {"a/byteorder", "big"}})), HasSubstr("big-endian"));
  EXPECT_THAT(ErrorOfReading(Pickle("N")), HasSubstr("is a pickle, but no checkpoint of PyTorch"));
  std::string newer = LegacyFile(kRoot, kStorages);
  newer.replace(newer.find(Bytes(1001, 8)), 8, Bytes(1002, 8));
  EXPECT_THAT(ErrorOfReading(newer), HasSubstr("is of an unknown version"));
}

// Every byte of a file is changed; what is read then is in bounds, and an error names the file.
TEST(ReadTorchFile, SurvivesChangedBytes) {
  for (const std::string& file : {ZipFile(kRoot, kStorages), LegacyFile(kRoot, kStorages)}) {
    int read = 0, refused = 0;
    for (size_t at = 4; at < file.size(); ++at) {
      for (const int byte : {0x00, 0x01, 0x28, 0x2e, 0x52, 0x7f, 0x80, 0xff}) {
        std::string changed = file;
        changed[at] = static_cast<char>(byte);
        PickleHeap heap;
        heap.file = "f.pt";
        try {
          ReadTorchFile(changed, &heap);
          ++read;
          for (const PickleStorage& storage : heap.storages) {
            EXPECT_EQ(storage.bytes.size(), static_cast<size_t>(storage.numel * storage.element.bytes));
            EXPECT_TRUE(storage.bytes.empty() || (storage.bytes.begin() >= changed.data() &&
                                                  storage.bytes.end() <= changed.data() + changed.size()));
          }
        } catch (const InputError& error) {
          ++refused;
          EXPECT_THAT(error.what(), StartsWith("f.pt: "));
        }
      }
    }
    EXPECT_GT(read, 0);
    EXPECT_GT(refused, 0);
  }
}

}  // namespace
}  // namespace oraclegs
