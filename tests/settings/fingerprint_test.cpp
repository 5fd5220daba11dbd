#include "oraclegs/settings/fingerprint.h"

#include "oraclegs/datasets/read_scene.h"
#include "oraclegs/image/codecs.h"
#include "run/fixtures.h"
#include "support/temp_dir.h"

namespace oraclegs {
namespace {

TEST(Fingerprint, IsSha256OfTheItemsAndTheirLengths) {
  EXPECT_EQ(Fingerprint().Hex(), Sha256().Hex());
  EXPECT_NE(Fingerprint().Add("ab").Add("c").Hex(), Fingerprint().Add("a").Add("bc").Hex());
  EXPECT_EQ(Fingerprint().Add("ab").Hex(), Fingerprint().Add("ab").Hex());
  EXPECT_NE(Fingerprint().Add(1.0).Hex(), Fingerprint().Add(2.0).Hex());
}

TEST(FileHashes, AreOfTheContentAndReadOnce) {
  const TempDir temp;
  WriteText(temp / "a", "same");
  WriteText(temp / "b", "same");
  FileHashes hashes;
  const std::string before = hashes.Of(temp / "a");
  EXPECT_EQ(before, Fingerprint().AddFile(temp / "a").Hex());
  EXPECT_EQ(hashes.Of(temp / "b"), before);
  WriteText(temp / "b", "Same");
  EXPECT_EQ(hashes.Of(temp / "b"), before) << "known";
  EXPECT_NE(FileHashes().Of(temp / "b"), before);
  EXPECT_NE(FileHashes().OfAll({temp / "a", temp / "b"}), hashes.OfAll({temp / "a", temp / "b"}));
  EXPECT_EQ(hashes.OfAll({}), "");
  EXPECT_THROW(hashes.Of(temp / "c"), InputError);
}

TEST(Fingerprint, OfWeightsIsThatOfNamesShapesAndSamples) {
  const std::string bytes(1024, 'a');
  const auto print = [](const std::string& data, const std::string& name, const std::string& said) {
    const std::map<std::string, TensorEntry> tensors = {{name, {"F32", {256}, data}}};
    const SafetensorsFile file = SafetensorsFile::Parse(SerializeSafetensors(tensors, {{"model", said}}), "a");
    return Fingerprint().AddTensors(file).Hex();
  };
  const std::string before = print(bytes, "w", "x");
  EXPECT_EQ(print(bytes, "w", "x"), before);
  EXPECT_NE(print(bytes, "v", "x"), before);
  EXPECT_NE(print(bytes, "w", "y"), before);
  for (const size_t at : {size_t{3}, bytes.size() - 3}) {
    std::string other = bytes;
    other[at] = 'b';
    EXPECT_NE(print(other, "w", "x"), before) << at;
  }
}

/// Fingerprint after rereading the files.
std::string Print(const Scene& scene, const std::vector<int>& views, int downscale) {
  FileHashes files;
  return ViewsFingerprint(scene, views, {.downscale = downscale}, &files);
}

TEST(ViewsFingerprint, ChangesWithPixelsMaskIntrinsicsAndPose) {
  const TempDir temp;
  WriteText(temp / "a.png", "pixels");
  WriteText(temp / "m.png", "mask");
  Scene scene;
  SceneView view;
  view.name = "a.png";
  view.image_path = temp / "a.png";
  view.intrinsics.params = {10, 10, 5, 5};
  view.cam_from_world = Eigen::Isometry3d::Identity();
  scene.views = {view};
  const std::string before = Print(scene, {0}, 1);
  EXPECT_EQ(Print(scene, {0}, 1), before);
  EXPECT_NE(Print(scene, {}, 1), before);

  scene.format = SceneFormat::kBlender;
  EXPECT_NE(Print(scene, {0}, 1), before);
  scene.format = SceneFormat::kPhotos;
  scene.views[0].intrinsics.width = 7;
  EXPECT_NE(Print(scene, {0}, 1), before);
  scene.views[0] = view;
  scene.views[0].intrinsics.height = 7;
  EXPECT_NE(Print(scene, {0}, 1), before);
  scene.views[0] = view;
  scene.views[0].as_stored = true;
  EXPECT_NE(Print(scene, {0}, 1), before);
  scene.views[0] = view;
  scene.views[0].intrinsics.params[0] = 11;
  EXPECT_NE(Print(scene, {0}, 1), before);
  scene.views[0] = view;
  scene.views[0].cam_from_world->translation().x() = 1;
  EXPECT_NE(Print(scene, {0}, 1), before);
  scene.views[0] = view;
  scene.views[0].mask_path = temp / "m.png";
  EXPECT_NE(Print(scene, {0}, 1), before);
  scene.views[0] = view;
  EXPECT_EQ(Print(scene, {0}, 1), before);
  WriteText(temp / "a.png", "Pixels");
  EXPECT_NE(Print(scene, {0}, 1), before);
}

TEST(ViewsFingerprint, IsOfTheFileThatTheDownscaleOpens) {
  const TempDir temp;
  Scene scene = ReadScene(MakeTinyScene(temp / "scene", 2), {}, Silent());
  const auto image = scene.views[0].image_path, small = temp / "scene" / "images_2" / image.filename();
  const std::string full = Print(scene, {0}, 1), half = Print(scene, {0}, 2);
  const auto write_small = [&](uint8_t gray, int width) {
    std::filesystem::create_directories(small.parent_path());
    WritePng(small, {width, 18, 3, std::vector<uint8_t>(static_cast<size_t>(width) * 18 * 3, gray)});
  };
  write_small(9, 24);
  const std::string with_small = Print(scene, {0}, 2);
  EXPECT_NE(with_small, half);
  EXPECT_EQ(Print(scene, {0}, 1), full);
  write_small(10, 24);
  EXPECT_NE(Print(scene, {0}, 2), with_small);
  write_small(10, 23);  // of another size: not used
  EXPECT_EQ(Print(scene, {0}, 2), half);
}

}  // namespace
}  // namespace oraclegs
