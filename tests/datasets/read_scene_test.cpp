#include "oraclegs/datasets/read_scene.h"

#include <cstdlib>
#include <nlohmann/json.hpp>

#include "oraclegs/scene/colmap_files.h"
#include "oraclegs/scene/colmap_model.h"
#include "oraclegs/scene/split.h"
#include "scene/tiny_scenes.h"
#include "support/errors.h"
#include "support/event_recorder.h"
#include "support/temp_dir.h"

namespace oraclegs {
namespace {

namespace fs = std::filesystem;
using nlohmann::json;
using ::testing::Contains;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;

class ReadSceneTest : public ::testing::Test {
 protected:
  Scene Read(const SceneReadOptions& options = {}) { return ReadScene(root(), options, events_.AsListener()); }
  std::string ReadError(const SceneReadOptions& options = {}) {
    return MessageOf<InputError>([&] { Read(options); });
  }
  void WriteImages(const char* folder) {
    for (const char* name : {"a.png", "b.png", "c.png"}) WriteImage(root() / folder / name);
  }
  const fs::path& root() const { return dir_.path(); }

  TempDir dir_;
  EventRecorder events_;
};

TEST_F(ReadSceneTest, FindsColmapModels) {
  WriteImages("images");
  for (const char* place : {"sparse/0", "sparse", "."}) {
    WriteTinyModel(root() / place);
    const Scene scene = Read();
    EXPECT_EQ(scene.format, SceneFormat::kColmap) << place;
    EXPECT_EQ(scene.views.size(), 3u) << place;
    EXPECT_EQ(scene.root, root());
    EXPECT_TRUE(scene.HasPoses());
    fs::remove_all(root() / "sparse");
  }
}

TEST_F(ReadSceneTest, TakesTheLargestOfSeveralModels) {
  WriteImages("images");
  WriteTinyModel(root() / "sparse/1");
  WriteColmapText(root() / "sparse/0", {{1, {CameraModel::kPinhole, 6, 4, {5, 5, 3, 2}}}},
                  {{.id = 1, .name = "a.png", .camera_id = 1}});
  EXPECT_EQ(Read().views.size(), 3u);
  EXPECT_THAT(events_.notes,
              Contains(HasSubstr("sparse/1: the largest of 2 models is used, with 3 of their 4 images")));
}

TEST_F(ReadSceneTest, FindsImagesInTheRootOrElsewhere) {
  WriteTinyModel(root() / "sparse/0");
  WriteImages(".");
  EXPECT_EQ(Read().views[0].image_path, root() / "a.png");
  fs::create_directories(root() / "images");  // holds none of them
  EXPECT_EQ(Read().views[0].image_path, root() / "a.png");
  WriteImages("photos");
  EXPECT_EQ(Read({.images = "photos"}).views[0].image_path, root() / "photos/a.png");
  EXPECT_EQ(Read({.images = root() / "photos"}).views[0].image_path, root() / "photos/a.png");
  EXPECT_THAT(ReadError({.images = "nowhere"}), HasSubstr("nowhere: no such folder"));
}

TEST_F(ReadSceneTest, NamesATruncatedModel) {
  WriteImages("images");
  const std::string files[][2] = {
      {"cameras.bin", TinyCamerasBin()}, {"images.bin", TinyImagesBin()}, {"points3D.bin", TinyPointsBin()}};
  for (const auto& [name, bytes] : files) {
    WriteTinyModel(root() / "sparse/0");
    WriteText(root() / "sparse/0" / name, bytes.substr(0, bytes.size() / 2));
    EXPECT_THAT(ReadError(), HasSubstr("sparse/0/" + name + ": ")) << name;
  }
}

json Transforms(const std::vector<std::string>& file_paths) {
  const json identity = {{1, 0, 0, 0}, {0, 1, 0, 0}, {0, 0, 1, 0}, {0, 0, 0, 1}};
  json file = {{"camera_angle_x", 0.7}, {"frames", json::array()}};
  for (const std::string& path : file_paths)
    file["frames"].push_back({{"file_path", path}, {"transform_matrix", identity}});
  return file;
}

TEST_F(ReadSceneTest, FindsTransforms) {
  WriteImages("images");
  WriteText(root() / "transforms.json", Transforms({"images/a", "images/b"}).dump());
  EXPECT_EQ(Read().format, SceneFormat::kTransforms);
  EXPECT_EQ(Read().views.size(), 2u);
}

TEST_F(ReadSceneTest, RefusesImagesElsewhere) {
  WriteImages("images");
  WriteImage(root() / ".." / (root().filename().string() + "_other") / "x.png");
  const fs::path elsewhere = fs::absolute(root()).parent_path() / (root().filename().string() + "_other");
  const auto write = [&](const std::string& path) {
    WriteText(root() / "transforms.json", Transforms({"images/a", path}).dump());
  };
  for (const std::string& path : {"../" + elsewhere.filename().string() + "/x.png", (elsewhere / "x.png").string(),
                                  "images/../../" + elsewhere.filename().string() + "/x"}) {
    write(path);
    EXPECT_THAT(ReadError(), testing::AllOf(HasSubstr("x.png, which lies outside"), HasSubstr("--allow-outside")));
    EXPECT_EQ(Read({.allow_outside = true}).views.size(), 2u) << path;
  }
  write((elsewhere / "x.png").string());
  EXPECT_EQ(Read({.images = elsewhere}).views.size(), 1u) << "the user named it";
  write("./images/../images/b.png");
  EXPECT_EQ(Read().views.size(), 2u);
  write((fs::absolute(root()) / "images/b.png").string());
  EXPECT_EQ(Read().views.size(), 2u);
  fs::create_symlink(elsewhere / "x.png", root() / "images" / "linked.png");
  write("images/linked.png");
  EXPECT_EQ(Read().views.size(), 2u) << "a link was made on this machine";
  json with_mask = Transforms({"images/a"});
  with_mask["frames"][0]["mask_path"] = "../" + elsewhere.filename().string() + "/x.png";
  WriteText(root() / "transforms.json", with_mask.dump());
  EXPECT_THAT(ReadError(), HasSubstr("lies outside"));
  fs::remove_all(elsewhere);
}

TEST_F(ReadSceneTest, TakesAbsoluteNamesOfAModelAsWrittenWhereThatIsAllowed) {
  WriteImages("images");
  const TempDir elsewhere;
  WriteImage(elsewhere / "a.png");
  const fs::path named = fs::absolute(elsewhere / "a.png");
  WriteColmapText(root() / "sparse/0", {{1, {CameraModel::kPinhole, 6, 4, {5, 5, 3, 2}}}},
                  {{.id = 1, .name = named.string(), .camera_id = 1}});
  EXPECT_EQ(Read().views.at(0).image_path, root() / "images/a.png") << "the scene was moved";
  EXPECT_EQ(Read({.allow_outside = true}).views.at(0).image_path, named);
}

TEST_F(ReadSceneTest, ScalesCamerasToSmallerPhotos) {
  for (const char* name : {"a.png", "b.png", "c.png"}) WriteImage(root() / "images" / name, 3, 2);
  WriteTinyModel(root() / "sparse/0");  // of 6 x 4
  const Scene scene = Read();
  EXPECT_EQ(scene.views[1].intrinsics.width, 3);
  EXPECT_EQ(scene.views[1].intrinsics.fy(), 5.5 / 2);
  EXPECT_THAT(events_.notes, Contains(HasSubstr("3 of 3 photos have another size than their cameras")));
}

TEST_F(ReadSceneTest, SaysWhichOfTwoPosesAreUsed) {
  WriteImages("images");
  WriteTinyModel(root() / "sparse/0");
  WriteText(root() / "transforms.json", Transforms({"images/a", "images/b"}).dump());
  EXPECT_EQ(Read().format, SceneFormat::kColmap);
  EXPECT_THAT(events_.notes, Contains(HasSubstr("the poses are those of the COLMAP model in")));
}

TEST_F(ReadSceneTest, FindsAModelBesideThePhotos) {
  WriteImages("images");
  WriteTinyModel(root() / "colmap/sparse/0");
  EXPECT_EQ(Read().format, SceneFormat::kColmap);
}

TEST_F(ReadSceneTest, TakesNoModelOfPhotosOutsideForASlashAtTheEnd) {
  WriteTinyModel(root() / "scene/colmap");
  WriteImages(".");
  WriteImage(root() / "scene/x.png");
  const Scene scene = ReadScene(root() / "scene/", {}, events_.AsListener());
  EXPECT_EQ(scene.root, root() / "scene");
  EXPECT_EQ(scene.format, SceneFormat::kPhotos);
}

TEST_F(ReadSceneTest, PrefersImagesToALayoutBesideThem) {
  WriteImages("images");
  for (const char* name : {"color/1.png", "depth/1.png"}) WriteImage(root() / name);
  EXPECT_EQ(Read().views.size(), 3u);
  fs::remove_all(root() / "images");
  EXPECT_EQ(Read().views.size(), 1u);
}

TEST_F(ReadSceneTest, ChecksMasksOfAllKinds) {
  WriteImages("images");
  WritePng(root() / "masks/b.png", {6, 4, 1, std::vector<uint8_t>(24, 0)});
  EXPECT_THAT(ReadError(), HasSubstr("masks/b.png: this mask ignores every pixel"));
  WriteTinyModel(root() / "sparse/0");
  EXPECT_THAT(ReadError(), HasSubstr("masks/b.png: this mask ignores every pixel"));
}

TEST_F(ReadSceneTest, FindsBlender) {
  WriteImages("train");
  WriteImages("test");
  WriteText(root() / "transforms_train.json", Transforms({"./train/a", "./train/b"}).dump());
  WriteText(root() / "transforms_test.json", Transforms({"./test/a"}).dump());
  const Scene scene = Read();
  EXPECT_EQ(scene.format, SceneFormat::kBlender);
  EXPECT_EQ(scene.views.size(), 3u);
}

TEST_F(ReadSceneTest, FindsPhotosHereOrInImages) {
  WriteImages(".");
  WriteText(root() / "._a.png", "what a Mac leaves behind");
  WriteText(root() / "notes.txt", "not an image");
  const Scene here = Read();
  EXPECT_EQ(here.format, SceneFormat::kPhotos);
  EXPECT_FALSE(here.HasPoses());
  ASSERT_EQ(here.views.size(), 3u);
  EXPECT_EQ(here.views[0].name, "a.png");
  EXPECT_FALSE(here.views[0].cam_from_world.has_value());
  EXPECT_EQ(here.views[0].intrinsics.width, 6);
  EXPECT_THAT(here.views[0].intrinsics.params, IsEmpty());

  WriteImage(root() / "images/d.png");
  EXPECT_EQ(Read().views.size(), 1u);
  EXPECT_EQ(Read({.images = "."}).views.size(), 4u);
}

TEST_F(ReadSceneTest, NamesPosesThatItDoesNotRead) {
  WriteImages("images");
  WriteText(root() / "trajectory.txt", "0 0 0");
  EXPECT_EQ(Read().views.size(), 3u);
  ASSERT_EQ(events_.notes.size(), 1u);
  EXPECT_THAT(events_.notes[0], HasSubstr("trajectory.txt has poses, which are not read"));
}

TEST_F(ReadSceneTest, AttachesMasks) {
  WriteImages("images");
  WriteImage(root() / "masks/b.png");
  const Scene scene = Read();
  EXPECT_TRUE(scene.views[0].mask_path.empty());
  EXPECT_EQ(scene.views[1].mask_path, root() / "masks/b.png");
}

TEST_F(ReadSceneTest, NamesWhatIsMissing) {
  EXPECT_THAT(ReadError(), HasSubstr("no scene found; expected a COLMAP model"));
  WriteText(root() / "file", "x");
  EXPECT_THAT(MessageOf<InputError>([&] { ReadScene(root() / "file", {}, Silent()); }),
              HasSubstr("file: is not a folder"));
  EXPECT_THAT(MessageOf<InputError>([&] { ReadScene(root() / "absent", {}, Silent()); }),
              HasSubstr("absent: no such folder"));
  WriteText(root() / "broken.jpg", "not a JPEG");
  EXPECT_THAT(ReadError(), HasSubstr("broken.jpg"));
}

TEST_F(ReadSceneTest, WritesNothing) {
  WriteImages("images");
  WriteTinyModel(root() / "sparse/0");
  const auto list = [&] {
    std::vector<std::string> entries;
    for (const auto& entry : fs::recursive_directory_iterator(root())) entries.push_back(entry.path().string());
    return entries;
  };
  const auto before = list();
  Read();
  EXPECT_EQ(list(), before);
}

TEST_F(ReadSceneTest, RefusesNamesThatAreNotUtf8) {
  WriteImages("images");
  WriteImage(root() / "images" / "caf\xE9.png");
  EXPECT_THAT(ReadError(), HasSubstr("images/caf\\xE9.png: "));
}

}  // namespace
}  // namespace oraclegs
