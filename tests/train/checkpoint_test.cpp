#include "oraclegs/train/checkpoint.h"

#include <cstring>
#include <fstream>

#include "oraclegs/core/files.h"
#include "support/errors.h"
#include "support/golden.h"
#include "support/temp_dir.h"
#include "train/gaussian_fixtures.h"

namespace oraclegs {
namespace {

using testing::HasSubstr;

Checkpoint Example(int64_t n) {
  Checkpoint c;
  c.iteration = 1234;
  c.gaussians = RandomGaussians(n, 1);
  c.gaussians.means[0] = -0.f;
  c.adam.m = RandomGaussians(n, 2);
  c.adam.v = RandomGaussians(n, 3);
  c.adam.step = 1233;
  c.sampler = {{5, 0, 3}, {2}, 0xfedcba9876543210, 6, 4};
  c.seconds = 0.1 + 0.2;
  c.loss = 1 / 3.0;
  c.options = {{"iterations", 7000}, {"opacity-reg", 0.01}, {"path", "caf\u00e9"}, {"on", true}};
  return c;
}

void ExpectSame(const Checkpoint& a, const Checkpoint& b) {
  EXPECT_EQ(a.iteration, b.iteration);
  EXPECT_TRUE(SameBits(a.gaussians, b.gaussians));
  EXPECT_TRUE(SameBits(a.adam.m, b.adam.m));
  EXPECT_TRUE(SameBits(a.adam.v, b.adam.v));
  EXPECT_EQ(a.adam.step, b.adam.step);
  EXPECT_EQ(a.sampler.photos, b.sampler.photos);
  EXPECT_EQ(a.sampler.proposals, b.sampler.proposals);
  EXPECT_EQ(a.sampler.counter, b.sampler.counter);
  EXPECT_EQ(a.sampler.num_photos, b.sampler.num_photos);
  EXPECT_EQ(a.sampler.num_proposals, b.sampler.num_proposals);
  EXPECT_EQ(a.exposures.maps, b.exposures.maps);
  EXPECT_EQ(a.exposures.m, b.exposures.m);
  EXPECT_EQ(a.exposures.v, b.exposures.v);
  EXPECT_EQ(a.exposures.steps, b.exposures.steps);
  EXPECT_EQ(std::memcmp(&a.seconds, &b.seconds, sizeof(double)), 0);
  EXPECT_EQ(std::memcmp(&a.loss, &b.loss, sizeof(double)), 0);
  EXPECT_EQ(a.options, b.options);
}

void Overwrite(const std::filesystem::path& path, const std::string& bytes) {
  std::ofstream(path, std::ios::binary | std::ios::trunc) << bytes;
}

/// "" when the file is accepted, else the message of the InputError.
std::string Refusal(const std::filesystem::path& path) {
  try {
    ReadCheckpoint(path);
  } catch (const InputError& e) {
    return e.what();
  }
  return "";
}

TEST(CheckpointTest, RoundTripIsExact) {
  TempDir dir;
  for (const int64_t n : {1, 2, 101}) {
    const auto path = CheckpointPath(dir / "made", n);
    const Checkpoint before = Example(n);
    WriteCheckpoint(path, before);
    ExpectSame(ReadCheckpoint(path), before);
  }
}

TEST(CheckpointTest, CompactMomentsStayCompact) {
  const TempDir dir;
  Checkpoint before = Example(3);
  before.adam = Adam(3, ShMoments::kCompact);
  for (int k = 0; k < 3 * kShFloats; ++k) before.adam.sh_m[k] = static_cast<uint16_t>(1000 + k);
  for (int k = 0; k < 3; ++k) before.adam.sh_v[k] = 0.5f + static_cast<float>(k);
  WriteCheckpoint(dir / "compact", before);
  const SafetensorsFile file = SafetensorsFile::Open(dir / "compact");
  EXPECT_EQ(file.Get("adam.m.sh").dtype, "BF16");
  EXPECT_THAT(file.Get("adam.v.sh").shape, testing::ElementsAre(3));
  const Adam after = ReadCheckpoint(dir / "compact").adam;
  EXPECT_EQ(after.sh_moments(), ShMoments::kCompact);
  EXPECT_TRUE(Equal(after.sh_m, before.adam.sh_m));
  EXPECT_TRUE(Equal(after.sh_v, before.adam.sh_v));
  EXPECT_FALSE(after.m.sh.defined());

  before.adam.sh_v = Buffer<float>::Zeros({2});
  EXPECT_THROW(WriteCheckpoint(dir / "uneven", before), ShapeError);
}

TEST(CheckpointTest, HalfMomentsStayHalf) {
  const TempDir dir;
  Checkpoint before = Example(3);
  before.adam = Adam(3, ShMoments::kHalf);
  for (int k = 0; k < 3 * kShFloats; ++k) {
    before.adam.sh_m[k] = static_cast<uint16_t>(1000 + k), before.adam.sh_v_half[k] = static_cast<uint16_t>(2000 + k);
  }
  WriteCheckpoint(dir / "half", before);
  const Adam after = ReadCheckpoint(dir / "half").adam;
  EXPECT_EQ(after.sh_moments(), ShMoments::kHalf);
  EXPECT_TRUE(Equal(after.sh_m, before.adam.sh_m));
  EXPECT_TRUE(Equal(after.sh_v_half, before.adam.sh_v_half));
}

ExposureMap Twelve(float first) {
  ExposureMap map;
  for (int k = 0; k < 12; ++k) map[k] = first + 0.1f * static_cast<float>(k);
  return map;
}

TEST(CheckpointTest, ExposuresAreThereWhereTheyAreTrained) {
  TempDir dir;
  Checkpoint before = Example(3);
  WriteCheckpoint(dir / "without", before);
  EXPECT_FALSE(SafetensorsFile::Open(dir / "without").Has("exposure.maps"));
  before.exposures = {{Twelve(1), Twelve(2)}, {Twelve(3), Twelve(4)}, {Twelve(5), Twelve(6)}, {7, 8}};
  WriteCheckpoint(dir / "with", before);
  EXPECT_THAT(SafetensorsFile::Open(dir / "with").Get("exposure.maps").shape, testing::ElementsAre(2, 3, 4));
  ExpectSame(ReadCheckpoint(dir / "with"), before);
  before.exposures.steps.push_back(9);  // of a photo without a map
  WriteCheckpoint(dir / "uneven", before);
  EXPECT_THAT(Refusal(dir / "uneven"), HasSubstr("exposure.maps has shape [2, 3, 4], expected [3, 3, 4]"));
}

TEST(CheckpointTest, StateIsReadBackByName) {
  const TempDir dir;
  Checkpoint before = Example(3), second = Example(2);
  second.state.arrays["sums"] = Buffer<float>::From({2}, {5, 6});
  before.state.arrays = {{"sums", Buffer<float>::From({3}, {1, 2, 3})}, {"grid", Buffer<float>::Full({2, 4}, 7)}};
  before.state.models["other"] = std::make_shared<const Checkpoint>(second);
  WriteCheckpoint(dir / "two", before);
  const Checkpoint after = ReadCheckpoint(dir / "two");
  ExpectSame(after, before);
  ASSERT_EQ(after.state.arrays.size(), 2u);
  EXPECT_TRUE(Equal(after.state.Array("sums", {3}), before.state.arrays["sums"]));
  EXPECT_TRUE(Equal(after.state.Array("grid", {2, 4}), before.state.arrays["grid"]));
  ASSERT_EQ(after.state.models.size(), 1u);
  ExpectSame(after.state.Model("other"), second);
  EXPECT_TRUE(Equal(after.state.Model("other").state.Array("sums", {2}), second.state.arrays["sums"]));
  EXPECT_TRUE(after.state.Model("other").state.models.empty());
}

TEST(CheckpointTest, StateThatIsMissingIsNamed) {
  NamedState state;
  state.arrays["sums"] = Buffer<float>::From({2}, {5, 6});
  EXPECT_THAT(MessageOf<InputError>([&] { state.Array("sums", {3}); }), HasSubstr("no state 'sums' of this training"));
  EXPECT_THAT(MessageOf<InputError>([&] { state.Array("views", {2}); }), HasSubstr("start anew with --overwrite"));
  EXPECT_THAT(MessageOf<InputError>([&] { state.Model("other"); }), HasSubstr("no model 'other' of this training"));
}

TEST(CheckpointTest, IsASafetensorsFileWithPlainNames) {
  TempDir dir;
  WriteCheckpoint(dir / "c.safetensors", Example(3));
  const auto file = SafetensorsFile::Open(dir / "c.safetensors");
  EXPECT_THAT(file.Get("sh").shape, testing::ElementsAre(3, 16, 3));
  EXPECT_THAT(file.Get("adam.v.quats").shape, testing::ElementsAre(3, 4));
  EXPECT_EQ(file.metadata().at("iteration"), "1234");
  EXPECT_EQ(file.metadata().at("format_version"), "3");
}

TEST(CheckSameOptions, NamesTheFirstThatDiffers) {
  EXPECT_NO_THROW(CheckSameOptions("runs/a", {{"seed", 1}}, {{"seed", 1}}));
  EXPECT_THAT(MessageOf<InputError>([] {
                CheckSameOptions("runs/a", {{"a", 1}, {"b", 2}}, {{"a", 1}, {"b", 3}});
              }),
              testing::AllOf(testing::HasSubstr("runs/a"), testing::HasSubstr("b 2, not 3")));
}

TEST(CheckpointTest, EveryFlippedByteIsFound) {
  TempDir dir;
  const auto path = dir / "c.safetensors";
  WriteCheckpoint(path, Example(1));
  const std::string good = ReadFile(path);
  std::fstream file(path, std::ios::binary | std::ios::in | std::ios::out);
  const auto put = [&](size_t at, char byte) { file.seekp(static_cast<std::streamoff>(at)).put(byte).flush(); };
  for (size_t at = 0; at < good.size(); ++at) {
    put(at, static_cast<char>(good[at] ^ (1 << at % 8)));
    ASSERT_THAT(Refusal(path), HasSubstr(path.string())) << "byte " << at;
    put(at, good[at]);
  }
  EXPECT_EQ(Refusal(path), "");
}

TEST(CheckpointTest, EveryTruncationIsFound) {
  TempDir dir;
  const auto path = dir / "c.safetensors";
  WriteCheckpoint(path, Example(1));
  const std::string good = ReadFile(path);
  for (size_t size = good.size() - 1; size < good.size(); size -= size < 2000 ? 1 : 37) {
    std::filesystem::resize_file(path, size);
    ASSERT_THAT(Refusal(path), HasSubstr(path.string())) << size;
  }
  Overwrite(path, good + "x");
  EXPECT_NE(Refusal(path), "");
}

TEST(CheckpointTest, RefusesForeignFiles) {
  TempDir dir;
  EXPECT_THAT(Refusal(dir / "missing.safetensors"), HasSubstr("missing.safetensors"));
  EXPECT_THAT(Refusal(GoldenDir() / "schedule.safetensors"), HasSubstr("not a checkpoint"));
  Overwrite(dir / "huge", std::string(8, '\xff') + "crc32=00000000");
  EXPECT_THAT(Refusal(dir / "huge"), HasSubstr("huge"));
}

TEST(CheckpointTest, UnwritableFolderIsARunError) {
  TempDir dir;
  Overwrite(dir / "file", "");
  EXPECT_THROW(WriteCheckpoint(dir / "file" / "c.safetensors", Example(1)), RunError);
}

}  // namespace
}  // namespace oraclegs
