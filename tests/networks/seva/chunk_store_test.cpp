#include "oraclegs/networks/seva/chunk_store.h"

#include "networks/fixtures.h"
#include "oraclegs/core/files.h"
#include "support/temp_dir.h"

namespace oraclegs::seva {
namespace {

TEST(SevaChunkStore, GivesBackWhatItKeeps) {
  const TempDir dir;
  const ChunkStore store(dir / "seva", "key");
  const Tensor images = at::arange(2 * 3 * 4 * 5).view({2, 3, 4, 5}).to(torch::kByte);
  EXPECT_FALSE(store.Read(0, 1, images.sizes()));
  store.Write(0, 1, images);
  const auto read = store.Read(0, 1, images.sizes());
  ASSERT_TRUE(read);
  EXPECT_TRUE(torch::equal(*read, images));
  EXPECT_FALSE(store.Read(1, 1, images.sizes()));
  EXPECT_FALSE(store.Read(0, 2, images.sizes()));
}

TEST(SevaChunkStore, DoesNotBelieveOtherKeysShapesAndDamage) {
  const TempDir dir;
  const Tensor images = torch::ones({1, 3, 2, 2}, torch::kByte);
  const ChunkStore store(dir.path(), "key");
  store.Write(0, 0, images);
  EXPECT_FALSE(ChunkStore(dir.path(), "other").Read(0, 0, images.sizes()));
  EXPECT_FALSE(store.Read(0, 0, {2, 3, 2, 2}));
  WriteFileAtomically(dir / "candidate_0_chunk_000.safetensors", "damaged");
  EXPECT_FALSE(store.Read(0, 0, images.sizes()));
}

TEST(SevaChunkStore, WithoutAFolderKeepsNothing) {
  const ChunkStore store({}, "key");
  store.Write(0, 0, torch::ones({1, 3, 2, 2}, torch::kByte));
  EXPECT_FALSE(store.Read(0, 0, {1, 3, 2, 2}));
}

}  // namespace
}  // namespace oraclegs::seva
