#include "oraclegs/pipeline/fingerprint.h"

#include "pipeline/fixtures.h"

namespace oraclegs {
namespace {

TEST(Fingerprint, IsFnv1aOfTheBytesAndTheirLength) {
  EXPECT_EQ(Fingerprint().Hex(), "cbf29ce484222325");
  EXPECT_NE(Fingerprint().Add("ab").Add("c").Hex(), Fingerprint().Add("a").Add("bc").Hex());
  EXPECT_EQ(Fingerprint().Add("ab").Hex(), Fingerprint().Add("ab").Hex());
  EXPECT_NE(Fingerprint().Add(1.0).Hex(), Fingerprint().Add(2.0).Hex());
}

TEST(Fingerprint, OfAFileIsThatOfItsContent) {
  const TempDir temp;
  WriteText(temp / "a", "same");
  WriteText(temp / "b", "same");
  EXPECT_EQ(FileFingerprint(temp / "a"), FileFingerprint(temp / "b"));
  WriteText(temp / "b", "Same");
  EXPECT_NE(FileFingerprint(temp / "a"), FileFingerprint(temp / "b"));
  EXPECT_THROW(FileFingerprint(temp / "c"), InputError);
}

TEST(ViewsFingerprint, ChangesWithPixelsMaskLensAndPose) {
  const TempDir temp;
  WriteText(temp / "a.png", "pixels");
  WriteText(temp / "m.png", "mask");
  Scene scene;
  SceneView view;
  view.name = "a.png";
  view.image_path = temp / "a.png";
  view.lens.params = {10, 10, 5, 5};
  view.cam_from_world = Eigen::Isometry3d::Identity();
  scene.views = {view};
  const std::string before = ViewsFingerprint(scene, {0});
  EXPECT_EQ(ViewsFingerprint(scene, {0}), before);
  EXPECT_NE(ViewsFingerprint(scene, {}), before);

  scene.views[0].lens.params[0] = 11;
  EXPECT_NE(ViewsFingerprint(scene, {0}), before);
  scene.views[0] = view;
  scene.views[0].cam_from_world->translation().x() = 1;
  EXPECT_NE(ViewsFingerprint(scene, {0}), before);
  scene.views[0] = view;
  scene.views[0].mask_path = temp / "m.png";
  EXPECT_NE(ViewsFingerprint(scene, {0}), before);
  scene.views[0] = view;
  EXPECT_EQ(ViewsFingerprint(scene, {0}), before);
  WriteText(temp / "a.png", "Pixels");
  EXPECT_NE(ViewsFingerprint(scene, {0}), before);
}

}  // namespace
}  // namespace oraclegs
