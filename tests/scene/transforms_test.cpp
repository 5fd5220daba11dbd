#include "oraclegs/scene/transforms.h"

#include <nlohmann/json.hpp>

#include "scene/tiny_scenes.h"
#include "support/errors.h"
#include "support/event_recorder.h"
#include "support/temp_dir.h"

namespace oraclegs {
namespace {

namespace fs = std::filesystem;
using nlohmann::json;
using ::testing::AllOf;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;

json Frame(const std::string& file_path) {
  const json identity = {{1, 0, 0, 0}, {0, 1, 0, 0}, {0, 0, 1, 0}, {0, 0, 0, 1}};
  return {{"file_path", file_path}, {"transform_matrix", identity}};
}

class TransformsTest : public ::testing::Test {
 protected:
  void Write(const std::vector<json>& frames, const char* name = "transforms.json") {
    WriteText(root() / name, json{{"fl_x", 5}, {"frames", frames}}.dump(1));
  }
  Scene Read(const SceneReadOptions& options = {}) {
    return ReadTransformsScene(root(), options, events_.AsListener());
  }
  std::string ReadError() {
    return MessageOf<InputError>([&] { Read(); });
  }
  const fs::path& root() const { return dir_.path(); }

  TempDir dir_;
  EventRecorder events_;
};

std::vector<std::string> Names(const Scene& scene) {
  std::vector<std::string> names;
  for (const SceneView& view : scene.views) names.push_back(view.name);
  return names;
}

TEST_F(TransformsTest, FindsImagesWithAndWithoutExtension) {
  for (const char* name : {"images/a.jpeg", "images/b.PNG", "images/c.v2.jpg"}) WriteImage(root() / name);
  Write({Frame("images/c.v2"), Frame("./images/a.jpeg"), Frame("images/b")});
  const Scene scene = Read();
  EXPECT_EQ(scene.format, SceneFormat::kTransforms);
  EXPECT_THAT(Names(scene), ElementsAre("images/a.jpeg", "images/b.PNG", "images/c.v2.jpg"));
  EXPECT_TRUE(fs::exists(scene.views[2].image_path));
  EXPECT_EQ(scene.views[0].intrinsics.width, 6);
  EXPECT_EQ(scene.views[0].intrinsics.cx(), 3);
  EXPECT_THAT(events_.warnings, IsEmpty());
}

TEST_F(TransformsTest, KnowsSpheresWithoutIntrinsics) {
  WriteImage(root() / "a.png", 8, 4);
  WriteImage(root() / "b.png", 8, 4);
  json sphere = Frame("a.png");
  sphere["camera_model"] = "EQUIRECTANGULAR";
  WriteText(root() / "transforms.json", json{{"fl_x", 5}, {"w", 80}, {"frames", {sphere, Frame("b.png")}}}.dump(1));
  const Scene scene = Read();
  EXPECT_TRUE(scene.views[0].is_sphere);
  EXPECT_EQ(scene.views[0].intrinsics.width, 8) << "the file's";
  EXPECT_TRUE(scene.views[0].intrinsics.params.empty());
  ASSERT_TRUE(scene.views[0].cam_from_world);
  EXPECT_TRUE(scene.views[0].cam_from_world->isApprox(*scene.views[1].cam_from_world, 1e-15)) << "looks the same way";
  EXPECT_FALSE(scene.views[1].is_sphere);
}

TEST_F(TransformsTest, LeavesOutFramesWithoutImage) {
  WriteImage(root() / "images/h.png");
  std::vector<json> frames{Frame("images/h.png")};
  for (const char* name : {"a", "b", "c", "d", "e", "f", "g"}) frames.push_back(Frame(name));
  Write(frames);
  const Scene scene = Read();
  EXPECT_THAT(Names(scene), ElementsAre("images/h.png"));
  EXPECT_EQ(scene.missing_images.size(), 7u);
  ASSERT_EQ(events_.warnings.size(), 1u);
  EXPECT_THAT(events_.warnings[0], AllOf(HasSubstr("7 of 8 views"), HasSubstr(": a, b, c, d, e and 2 more")));
}

TEST_F(TransformsTest, ReadsAnotherImageFolder) {
  for (const char* folder : {"half", "quarter"}) WriteImage(root() / folder / "a.png", 3, 2);  // either could be meant
  Write({Frame("images/a.png")});
  EXPECT_THAT(ReadError(), HasSubstr("none of its 1 views has an image file"));
  const Scene scene = Read({.images = "half"});
  EXPECT_EQ(scene.views.at(0).image_path, root() / "half/a.png");
  EXPECT_EQ(scene.views[0].name, "images/a.png");
}

TEST_F(TransformsTest, FollowsPathsOutOfTheScene) {
  WriteImage(root() / "inside/../outside.png");
  fs::create_directories(root() / "inside");
  WriteText(root() / "inside/transforms.json",
            json{{"fl_x", 5}, {"frames", {Frame("../outside.png"), Frame("../no")}}}.dump());
  const Scene scene = ReadTransformsScene(root() / "inside", {}, events_.AsListener());
  EXPECT_THAT(Names(scene), ElementsAre("outside.png"));
  EXPECT_THAT(scene.missing_images, ElementsAre("no"));
}

TEST_F(TransformsTest, ReadsMasksOfFrames) {
  for (const char* name : {"a.png", "b.png", "m/a.png"}) WriteImage(root() / name);
  json a = Frame("a.png"), b = Frame("b.png");
  a["mask_path"] = "m/a.png";
  b["mask_path"] = "m/b.png";
  Write({a, b});
  const Scene scene = Read();
  EXPECT_EQ(scene.views[0].mask_path, root() / "m/a.png");
  EXPECT_TRUE(scene.views[1].mask_path.empty());
  ASSERT_EQ(events_.warnings.size(), 1u);
  EXPECT_THAT(events_.warnings[0], HasSubstr("1 mask files do not exist, those views use all pixels: m/b.png"));
}

TEST_F(TransformsTest, ReadsPathsOfAnotherMachine) {
  for (const char* name : {"images/a.png", "images/b.png", "masks/b.png"}) WriteImage(root() / name);
  json b = Frame("D:\\scan\\images\\b.png");
  b["mask_path"] = "D:\\scan\\masks\\b.png";
  Write({Frame("/home/me/scan/images/a"), b});
  const Scene scene = Read();
  EXPECT_THAT(Names(scene), ElementsAre("images/a.png", "images/b.png"));
  EXPECT_EQ(scene.views[0].image_path, root() / "images/a.png");
  EXPECT_EQ(scene.views[1].mask_path, root() / "masks/b.png");
  EXPECT_THAT(events_.notes, ElementsAre(HasSubstr("2 of 2 paths"), HasSubstr("1 of 1 path")));
}

TEST_F(TransformsTest, FindsDepthOfASensor) {
  for (const char* name : {"a.png", "b.png", "c.png", "depth/a.png", "depth/b.png", "conf/b.png"}) {
    WriteImage(root() / name);
  }
  json a = Frame("a.png"), b = Frame("b.png");
  a["depth_file_path"] = "depth/a.png";
  b["depth_file_path"] = "D:\\scan\\depth\\b.png";
  b["confidence_file_path"] = "conf/b.png";
  b["depth_unit_scale_factor"] = 0.25;
  Write({a, b, Frame("c.png")});
  const Scene scene = Read();
  EXPECT_EQ(scene.views[0].depth_path, root() / "depth/a.png");
  EXPECT_EQ(scene.views[0].confidence_path, "");
  EXPECT_EQ(scene.views[0].depth_unit, 1e-3) << "as Nerfstudio has it";
  EXPECT_EQ(scene.views[1].depth_path, root() / "depth/b.png");
  EXPECT_EQ(scene.views[1].confidence_path, root() / "conf/b.png");
  EXPECT_EQ(scene.views[1].depth_unit, 0.25);
  EXPECT_EQ(scene.views[2].depth_path, "");
  EXPECT_THAT(events_.warnings, IsEmpty());
}

TEST_F(TransformsTest, SaysWhichDepthOfASensorIsNotUsed) {
  for (const char* name : {"a.png", "b.png", "c.png", "depth/b.png", "depth/c.npy"}) WriteImage(root() / name);
  json a = Frame("a.png"), b = Frame("b.png"), c = Frame("c.png");
  a["depth_file_path"] = "depth/a.png";
  b["depth_file_path"] = "depth/b.png";
  b["confidence_file_path"] = "conf/b.png";
  c["depth_file_path"] = "depth/c.npy";
  Write({a, b, c});
  for (const SceneView& view : Read().views) EXPECT_EQ(view.depth_path, "") << view.name;
  EXPECT_THAT(events_.notes, ElementsAre(AllOf(HasSubstr("is no PNG"), HasSubstr("depth/c.npy"))));
  EXPECT_THAT(events_.warnings, ElementsAre(AllOf(HasSubstr("2 files"), HasSubstr("depth/a.png, conf/b.png"))));
  b["integer_depth_scale"] = 0;
  Write({a, b, c});
  EXPECT_THAT(ReadError(), AllOf(HasSubstr("frame 'b.png'"), HasSubstr("\"integer_depth_scale\" is 0; give")));
}

TEST_F(TransformsTest, FindsTheStartCloud) {
  WriteImage(root() / "a.png");
  const auto write = [&](const json& points) {
    WriteText(root() / "transforms.json",
              json{{"fl_x", 5}, {"ply_file_path", points}, {"frames", {Frame("a.png")}}}.dump());
  };
  write("clouds\\p.ply");
  EXPECT_TRUE(Read().point_file.empty());
  EXPECT_THAT(events_.warnings, ElementsAre(HasSubstr("names points (clouds\\p.ply) that do not exist")));
  WriteText(root() / "clouds/p.ply", "");
  EXPECT_EQ(Read().point_file, root() / "clouds/p.ply");
  write(7);
  EXPECT_THAT(ReadError(), HasSubstr("\"ply_file_path\" is not text"));
}

/// The poses are in the coordinates that Nerfstudio turned and scaled a model to.
TEST_F(TransformsTest, LeavesAppliedTransformsAlone) {
  WriteImage(root() / "a.png");
  const json turn = {{0, 1, 0, 5}, {1, 0, 0, 0}, {0, 0, -1, 0}};
  WriteText(
      root() / "transforms.json",
      json{{"fl_x", 5}, {"applied_transform", turn}, {"applied_scale", 0.25}, {"frames", {Frame("a.png")}}}.dump());
  const Eigen::Matrix4d flip = Eigen::Vector4d(1, -1, -1, 1).asDiagonal();
  EXPECT_EQ(Read().views[0].cam_from_world->matrix(), flip);
}

TEST_F(TransformsTest, SaysThatRotationsAreRounded) {
  for (const char* name : {"a.png", "b.png"}) WriteImage(root() / name);
  json rounded = Frame("a.png");
  rounded["transform_matrix"] = {{0.5, -0.866, 0, 0}, {0.866, 0.5, 0, 0}, {0, 0, 0.999, 0}, {0, 0, 0, 1}};
  Write({rounded, Frame("b.png")});
  Read();
  EXPECT_THAT(events_.notes, ElementsAre(HasSubstr("1 of 2 rotations are off by up to 0.001")));
}

TEST_F(TransformsTest, LocatesSyntaxErrors) {
  WriteText(root() / "transforms.json", "{\n \"frames\": [\n  }\n");
  EXPECT_THAT(ReadError(), AllOf(HasSubstr("transforms.json: is not valid JSON"), HasSubstr("line 3")));
  WriteText(root() / "transforms.json", "");
  EXPECT_THAT(ReadError(), HasSubstr("is not valid JSON"));
  WriteText(root() / "transforms.json", "{\"frames\": [1e999]}");
  EXPECT_THAT(ReadError(), HasSubstr("is not valid JSON"));
  WriteText(root() / "transforms.json", "{\"frames\": \"\xff\"}");
  EXPECT_THAT(ReadError(), HasSubstr("is not valid JSON"));
}

TEST_F(TransformsTest, NamesTheFrameWithANaN) {
  for (const char* name : {"a.png", "NaN\"b.png"}) WriteImage(root() / name);
  const char* start = R"({"fl_x": 5, "frames": [{"file_path": ")";
  const char* matrix = R"(", "transform_matrix": [[1, 0, 0, 0], [0, 1, 0, )";
  WriteText(root() / "transforms.json", std::string(start) + "a" + matrix + "NaN], [0, 0, 1, 0]]}]}");
  EXPECT_THAT(ReadError(), HasSubstr("frame 'a': \"transform_matrix\" is not a finite number"));
  WriteText(root() / "transforms.json", std::string(start) + "a" + matrix + "-Infinity], [0, 0, 1, 0]]}]}");
  EXPECT_THAT(ReadError(), HasSubstr("frame 'a': \"transform_matrix\" is not a finite number"));
  // These letters inside a string are a name.
  WriteText(root() / "transforms.json", std::string(start) + "NaN\\\"b" + matrix + "0], [0, 0, 1, 0]]}]}");
  EXPECT_THAT(Names(Read()), ElementsAre("NaN\"b.png"));
}

TEST_F(TransformsTest, RefusesOtherLayouts) {
  for (const char* text : {"[]", "3", "{}", "{\"frames\": []}", "{\"frames\": {}}"}) {
    WriteText(root() / "transforms.json", text);
    EXPECT_THAT(ReadError(), HasSubstr("transforms.json: has no \"frames\"")) << text;
  }
  for (const char* frame : {"3", "{}", "{\"file_path\": 3}"}) {
    WriteText(root() / "transforms.json", std::string("{\"frames\": [") + frame + "]}");
    EXPECT_THAT(ReadError(), HasSubstr("frame 0: has no \"file_path\"")) << frame;
  }
  WriteText(root() / "transforms.json", "{\"frames\": [{\"file_path\": \"..\"}]}");
  EXPECT_THAT(ReadError(), HasSubstr("\"file_path\" is empty"));
  WriteText(root() / "transforms.json", "{\"frames\": [{\"file_path\": \"a\\u0000b\"}]}");
  EXPECT_THAT(ReadError(), HasSubstr("control characters"));
}

TEST_F(TransformsTest, NamesBadFrames) {
  WriteImage(root() / "a.png");
  json scaled = Frame("a");
  for (int i = 0; i < 3; ++i) scaled["transform_matrix"][i][i] = 2;
  Write({scaled});
  EXPECT_THAT(ReadError(), HasSubstr("transforms.json: frame 'a': \"transform_matrix\" is a rotation scaled by 2"));
  json zero_focal = Frame("a");
  zero_focal["fl_x"] = 0;
  Write({zero_focal});
  EXPECT_THAT(ReadError(), HasSubstr("transforms.json: frame 'a'"));
  Write({Frame("a"), Frame("a.png")});
  EXPECT_THAT(ReadError(), HasSubstr("'a.png' twice"));
}

TEST_F(TransformsTest, RefusesEveryPrefix) {
  WriteImage(root() / "a.png");
  const std::string text = json{{"fl_x", 5}, {"frames", json::array({Frame("a")})}}.dump();
  for (size_t n = 0; n < text.size(); ++n) {
    WriteText(root() / "transforms.json", text.substr(0, n));
    EXPECT_THROW(Read(), InputError) << n;
  }
}

class BlenderTest : public TransformsTest {
 protected:
  Scene ReadBlender() { return ReadBlenderScene(root(), {}, events_.AsListener()); }
};

TEST_F(BlenderTest, GivesViewsTheRoleOfTheirFile) {
  for (const char* name : {"train/r_0.png", "train/r_1.png", "test/r_0.png", "val/r_0.png"}) WriteImage(root() / name);
  Write({Frame("./train/r_1"), Frame("./train/r_0")}, "transforms_train.json");
  Write({Frame("./test/r_0")}, "transforms_test.json");
  Write({Frame("./val/r_0"), Frame("./test/r_0")}, "transforms_val.json");
  const Scene scene = ReadBlender();
  EXPECT_EQ(scene.format, SceneFormat::kBlender);
  EXPECT_THAT(Names(scene), ElementsAre("test/r_0.png", "train/r_0.png", "train/r_1.png", "val/r_0.png"));
  EXPECT_EQ(scene.views[0].role, DeclaredRole::kTest);
  EXPECT_EQ(scene.views[1].role, DeclaredRole::kTrain);
  EXPECT_EQ(scene.views[3].role, DeclaredRole::kVal);
  EXPECT_THAT(events_.warnings, IsEmpty());
}

TEST_F(BlenderTest, WarnsWithoutATestFile) {
  WriteImage(root() / "train/r_0.png");
  Write({Frame("./train/r_0")}, "transforms_train.json");
  EXPECT_EQ(ReadBlender().views.size(), 1u);
  ASSERT_EQ(events_.warnings.size(), 1u);
  EXPECT_THAT(events_.warnings[0], HasSubstr("no view is held out"));
}

TEST_F(BlenderTest, TakesNoImageOfAnotherPart) {
  for (const char* name : {"Train/r_0.png", "Train/r_1.png"}) WriteImage(root() / name);
  Write({Frame("./train/r_0"), Frame("./train/r_1")}, "transforms_train.json");
  Write({Frame("./test/r_0"), Frame("./test/r_1")}, "transforms_test.json");
  EXPECT_THAT(Names(ReadBlender()), ElementsAre("Train/r_0.png", "Train/r_1.png"));
  EXPECT_THAT(events_.warnings, ElementsAre(HasSubstr("2 of 4 views have no image file")));
}

TEST_F(BlenderTest, RefusesAViewInTrainAndTest) {
  WriteImage(root() / "train/r_0.png");
  Write({Frame("./train/r_0")}, "transforms_train.json");
  Write({Frame("./train/r_0")}, "transforms_test.json");
  EXPECT_THAT(MessageOf<InputError>([&] { ReadBlender(); }), HasSubstr("'train/r_0.png' twice"));
}

}  // namespace
}  // namespace oraclegs
