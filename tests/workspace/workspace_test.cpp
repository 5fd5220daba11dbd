#include "oraclegs/workspace/workspace.h"

#include "run/fixtures.h"
#include "support/errors.h"
#include "support/event_recorder.h"
#include "support/temp_dir.h"

namespace oraclegs {
namespace {

using testing::AllOf;
using testing::HasSubstr;

class WorkspaceTest : public testing::Test {
 protected:
  WorkspaceTest() { std::filesystem::create_directories(scene); }

  Workspace Claim(bool overwrite = false) { return Workspace::Claim(out, scene, options, overwrite); }
  std::string Refusal(bool overwrite = false) {
    return MessageOf<InputError>([&] { Claim(overwrite); });
  }

  TempDir temp;
  std::filesystem::path scene = temp / "scene", out = temp / "out";
  RunOptions options;
};

TEST_F(WorkspaceTest, TakesAMissingAndAnEmptyFolderAndSaysWhoseItIs) {
  EXPECT_FALSE(IsWorkspace(out));
  { const Workspace workspace = Claim(); }
  EXPECT_TRUE(IsWorkspace(out));
  const SavedRun saved = ReadSavedRun(out);
  EXPECT_EQ(saved.scene, std::filesystem::canonical(scene));
  EXPECT_EQ(saved.options, RunOptionsToJson(options));
}

TEST_F(WorkspaceTest, RefusesAFolderThatAnotherRunHolds) {
  const Workspace workspace = Claim();
  EXPECT_THAT(Refusal(), HasSubstr("another oraclegs is working there"));
}

TEST_F(WorkspaceTest, NoticesThatItIsGone) {
  Workspace workspace = Claim();
  std::vector<std::string> heard;
  const Listener watching = workspace.Watching(
      [&](const Event& event) { heard.push_back(std::holds_alternative<StepDone>(event) ? "step" : "other"); });
  watching(StepDone{"train", 1, 2, "iterations", ""});
  EXPECT_NO_THROW(workspace.RequireThere());
  std::filesystem::remove_all(out);
  watching(Note{"it may still speak"});
  const auto gone = HasSubstr(out.string() + ": was removed or replaced");
  EXPECT_THAT(MessageOf<RunError>([&] { watching(StepDone{"train", 2, 2, "iterations", ""}); }), gone);
  EXPECT_THAT(MessageOf<RunError>([&] { workspace.MarkDone("train", {{"key", "k"}}); }), gone);
  EXPECT_FALSE(std::filesystem::exists(out)) << "nothing is written there";
  std::filesystem::create_directories(out);
  EXPECT_THAT(MessageOf<RunError>([&] { workspace.RequireThere(); }), gone) << "it is another folder";
  EXPECT_THAT(heard, testing::ElementsAre("step", "other"));
}

TEST_F(WorkspaceTest, NoticesThatItsFilesAreGone) {
  const Workspace workspace = Claim();
  EXPECT_NO_THROW(workspace.RequireThere());
  std::filesystem::remove(workspace.options());
  EXPECT_THAT(MessageOf<RunError>([&] { workspace.RequireThere(); }),
              HasSubstr(out.string() + ": was removed or replaced"));
}

TEST_F(WorkspaceTest, ForgetsRecordsThatAreDamaged) {
  EventRecorder recorder;
  Workspace workspace = Claim();
  workspace.MarkDone("sfm", {{"key", "k"}, {"files", nlohmann::json::array()}});
  workspace.DropDamagedRecords(recorder.AsListener());
  EXPECT_THAT(recorder.warnings, testing::IsEmpty());
  WriteText(out / "stages.json", R"({"sfm": {"key": "k", "files": []}, "train": {"key": 3}, "depth": 5})");
  EXPECT_TRUE(workspace.Record("train").is_null());
  workspace.DropDamagedRecords(recorder.AsListener());
  EXPECT_THAT(recorder.warnings, testing::ElementsAre(AllOf(HasSubstr("stages.json"), HasSubstr("depth, train"))));
  EXPECT_EQ(ReadRunJson(out / "stages.json").size(), 1u);
  EXPECT_TRUE(workspace.IsDone("sfm", "k"));
  WriteText(out / "stages.json", "{");
  workspace.DropDamagedRecords(recorder.AsListener());
  EXPECT_THAT(recorder.warnings.back(), HasSubstr("all stages are made again"));
  EXPECT_EQ(ReadRunJson(out / "stages.json"), nlohmann::json::object());
}

TEST_F(WorkspaceTest, ContinuesTheSameRunHoweverThePathIsSpelled) {
  { const Workspace workspace = Claim(); }
  WriteText(out / "point_cloud.ply", "x");
  options.machine.threads = 7;  // changes nothing in the result
  options.checkpoints.checkpoint_every = 3;
  EXPECT_NO_THROW(Workspace::Claim(out / ".", temp.path() / "out" / ".." / "scene" / "", options, false));
}

TEST_F(WorkspaceTest, RefusesOtherOptionsWithTheirNamesAndValues) {
  { const Workspace workspace = Claim(); }
  WriteText(out / "point_cloud.ply", "x");
  options.train.iterations = 200;
  options.split.test_views = "a,b";
  EXPECT_THAT(Refusal(), AllOf(HasSubstr(out.string()), HasSubstr("--iterations was auto, now is 200"),
                               HasSubstr("--test-views was not given, now is a,b"), HasSubstr("--overwrite"),
                               testing::Not(HasSubstr("\n"))));
  EXPECT_THAT(ReadSavedRun(out).options.at("iterations"), "auto");
}

TEST_F(WorkspaceTest, ATrainedRunGoesOnWithMoreIterationsAlone) {
  options.train.iterations = 100;
  { const Workspace workspace = Claim(); }
  WriteText(out / "point_cloud.ply", "x");
  options.train.iterations = 200;
  EXPECT_THAT(Refusal(), HasSubstr("--iterations was 100, now is 200")) << "it has not trained to its end";
  WriteText(out / "stages.json", R"({"train": {"key": "k", "files": []}})");
  EXPECT_THAT(Refusal(), HasSubstr("--iterations was 100, now is 200")) << "there is nothing to go on from";
  WriteText(out / "stages.json", R"({"train": {"key": "k", "files": []}})");
  WriteText(out / "checkpoints" / "iteration_0000100.safetensors", "x");
  options.start.seed = 1;
  EXPECT_THAT(Refusal(), HasSubstr("--seed was 0, now is 1"));
  options.start.seed = 0;
  EXPECT_EQ(Refusal(), "");
  EXPECT_EQ(ReadSavedRun(out).options.at("iterations"), 200);
  EXPECT_EQ(ReadSavedRun(out).start_iterations, 100);
  options.train.iterations = 300;
  EXPECT_EQ(Refusal(), "");
  EXPECT_EQ(Refusal(), "");
  EXPECT_EQ(ReadSavedRun(out).start_iterations, 100) << "of the run's beginning";
  options.train.iterations = 250;
  EXPECT_THAT(Refusal(), HasSubstr("--iterations was 300, now is 250"));
  EXPECT_EQ(Refusal(true), "");
  EXPECT_EQ(ReadSavedRun(out).start_iterations, 0);
}

TEST_F(WorkspaceTest, AnAutomaticNumberOfIterationsGoesOn) {
  { Workspace::Claim(out, scene, options, false, {nlohmann::json{{"iterations", 100}}, {}, true}); }
  WriteText(out / "point_cloud.ply", "x");
  WriteText(out / "stages.json", R"({"train": {"key": "k", "files": []}})");
  WriteText(out / "checkpoints" / "iteration_0000100.safetensors", "x");
  options.train.iterations = 90;
  EXPECT_THAT(Refusal(), HasSubstr("--iterations was auto, now is 90"));
  options.train.iterations = 150;
  EXPECT_EQ(Refusal(), "");
  EXPECT_EQ(ReadSavedRun(out).start_iterations, 100);
}

TEST_F(WorkspaceTest, KnowsWhatWasImportedAlsoWhenItIsMoved) {
  const auto claim = [&](const std::vector<std::filesystem::path>& inputs) {
    return Workspace::Claim(out, WorkspacePaths(out).photos(), options, false, {nullptr, inputs, true});
  };
  const std::filesystem::path a = scene / "a.jpg", b = scene / "b.jpg";
  { const Workspace workspace = claim({a, b}); }
  WriteText(out / "sfm/points.ply", "x");
  EXPECT_NO_THROW(claim({a, scene / "." / "b.jpg"}));
  EXPECT_THAT(MessageOf<InputError>([&] { claim({a}); }), HasSubstr("holds a run of another scene"));
  EXPECT_THAT(Refusal(), HasSubstr("holds a run of another scene"));
  std::filesystem::rename(out, temp / "moved");
  const SavedRun saved = ReadSavedRun(temp / "moved");
  EXPECT_EQ(saved.inputs, (std::vector<std::string>{a.string(), b.string()}));
  EXPECT_EQ(saved.scene, std::filesystem::canonical(temp.path()) / "moved/photos");
}

TEST_F(WorkspaceTest, ACheckpointIsAResultToProtect) {
  { const Workspace workspace = Claim(); }
  options.start.seed = 1;
  std::filesystem::create_directories(out / "checkpoints");
  EXPECT_EQ(Refusal(), "");  // nothing is lost yet
  options.start.seed = 2;
  WriteText(out / "checkpoints" / "iteration_0000001.safetensors", "x");
  EXPECT_THAT(Refusal(), HasSubstr("--seed was 1, now is 2"));
}

TEST_F(WorkspaceTest, OptionsMayChangeBeforeThereIsAResult) {
  { const Workspace workspace = Claim(); }
  options.train.iterations = 5;
  { const Workspace workspace = Claim(); }
  EXPECT_EQ(ReadSavedRun(out).options.at("iterations"), 5);
}

TEST_F(WorkspaceTest, RefusesAnotherScene) {
  { const Workspace workspace = Claim(); }
  std::filesystem::create_directories(temp / "other");
  std::filesystem::create_directories(out / "sfm");
  const std::string message = MessageOf<InputError>([&] { Workspace::Claim(out, temp / "other", options, false); });
  EXPECT_THAT(message, AllOf(HasSubstr("another scene"), HasSubstr(scene.string()), HasSubstr("-o")));
  std::filesystem::remove(out / "sfm");  // then nothing has been made of the scene that was named by mistake
  EXPECT_NO_THROW(Workspace::Claim(out, temp / "other", options, false));
}

TEST_F(WorkspaceTest, RefusesFilesOfSomebodyElseEvenWithOverwrite) {
  std::filesystem::create_directories(out);
  WriteText(out / "thesis.tex", "precious");
  EXPECT_THAT(Refusal(), AllOf(HasSubstr(out.string()), HasSubstr("not empty")));
  EXPECT_THAT(Refusal(true), HasSubstr("not empty"));
  WriteText(out / "options.json", R"({"color": "blue"})");
  EXPECT_THAT(Refusal(true), HasSubstr("was not written by oraclegs"));
  EXPECT_TRUE(std::filesystem::exists(out / "thesis.tex"));
}

TEST_F(WorkspaceTest, ALeftoverOfAKilledRunIsNobodysFile) {
  std::filesystem::create_directories(out);
  WriteText(out / ".oraclegs-999999999-0.tmp", "half");
  WriteText(out / "depth" / ".oraclegs-999999999-1.tmp", "half");
  std::filesystem::rename(out / "depth", out / ".oraclegs-photos.tmp");
  EXPECT_EQ(Refusal(), "");
  EXPECT_FALSE(std::filesystem::exists(out / ".oraclegs-999999999-0.tmp"));
  EXPECT_FALSE(std::filesystem::exists(out / ".oraclegs-photos.tmp"));
}

TEST_F(WorkspaceTest, OverwriteRemovesTheRunAndNothingElse) {
  { const Workspace workspace = Claim(); }
  WriteText(out / "point_cloud.ply", "x");
  WriteText(out / "notes.txt", "mine");
  std::filesystem::create_directories(out / "sfm" / "sparse");
  options.train.iterations = 3;
  { const Workspace workspace = Claim(true); }
  EXPECT_FALSE(std::filesystem::exists(out / "point_cloud.ply"));
  EXPECT_FALSE(std::filesystem::exists(out / "sfm"));
  EXPECT_TRUE(std::filesystem::exists(out / "notes.txt"));
  EXPECT_EQ(ReadSavedRun(out).options.at("iterations"), 3);
}

TEST_F(WorkspaceTest, NeverWritesIntoTheScene) {
  for (const auto& dir : {scene, scene / "out", scene / ".." / "scene" / "a" / "b"}) {
    const std::string message = MessageOf<InputError>([&] { Workspace::Claim(dir, scene, options, false); });
    EXPECT_THAT(message, AllOf(HasSubstr("scene folder"), HasSubstr("-o"))) << dir;
  }
  EXPECT_TRUE(std::filesystem::is_empty(scene));
  EXPECT_NO_THROW(RequireOutsideScene(temp / "scene2", scene));  // a name that only begins alike
  EXPECT_NO_THROW(RequireOutsideScene(temp.path(), scene));
}

TEST_F(WorkspaceTest, AFolderThatCannotBeMadeIsARunError) {
  WriteText(temp / "file", "x");
  out = temp / "file" / "out";
  EXPECT_THAT(MessageOf<RunError>([&] { Claim(); }), HasSubstr("file"));
}

TEST_F(WorkspaceTest, TwoRunsDoNotShareAFolder) {
  {
    const Workspace first = Claim();
    EXPECT_THAT(Refusal(), HasSubstr("another oraclegs is working there"));
  }
  EXPECT_EQ(Refusal(), "");
}

TEST_F(WorkspaceTest, OpenTakesOnlyAWorkspace) {
  EXPECT_THROW(Workspace::Open(temp.path()), InputError);
  { const Workspace workspace = Claim(); }
  EXPECT_EQ(Workspace::Open(out).root(), out);
}

TEST_F(WorkspaceTest, DamagedOptionsAreNamed) {
  { const Workspace workspace = Claim(); }
  for (const char* text : {"{", "[]", "{}", R"({"program":"oraclegs","format":99,"scene":"/x","options":{}})"}) {
    WriteText(out / "options.json", text);
    EXPECT_THAT(MessageOf<InputError>([&] { ReadSavedRun(out); }), HasSubstr("options.json")) << text;
  }
}

TEST_F(WorkspaceTest, RemembersFinishedStagesUntilInputsOrFilesChange) {
  Workspace workspace = Claim();
  EXPECT_FALSE(workspace.IsDone("train", "k1"));
  EXPECT_TRUE(workspace.Record("train").is_null());
  WriteText(out / "point_cloud.ply", "x");
  workspace.MarkDone("train", {{"key", "k1"}, {"seconds", 2.5}, {"files", {"point_cloud.ply"}}});
  workspace.MarkDone("sfm", {{"key", "k0"}, {"seconds", 1}, {"files", nlohmann::json::array()}});
  EXPECT_TRUE(workspace.IsDone("train", "k1"));
  EXPECT_TRUE(workspace.IsDone("sfm", "k0"));
  EXPECT_FALSE(workspace.IsDone("train", "k2"));
  EXPECT_EQ(workspace.Record("train").at("seconds"), 2.5);
  std::filesystem::remove(out / "point_cloud.ply");
  EXPECT_FALSE(workspace.IsDone("train", "k1"));
}

TEST(DescribeDifference, ComparesWithDefaultsWhatAnOlderRunDidNotSave) {
  RunOptions options;
  EXPECT_EQ(DescribeDifference(nlohmann::json::object(), options), "");
  options.image.downscale = 2;
  EXPECT_EQ(DescribeDifference(nlohmann::json::object(), options), "--downscale was auto, now is 2");
  EXPECT_EQ(DescribeDifference({{"downscale", 2}, {"gone", 1}}, options), "");
}

TEST_F(WorkspaceTest, NeverWritesIntoThePhotographsFolderEither) {
  Scene posed;
  posed.root = scene;
  posed.views.resize(2);
  posed.views[0].image_path = scene / "images" / "a.png";
  posed.views[1].image_path = temp / "photos" / "left" / "b.png";
  const auto refusal = [&](const std::filesystem::path& dir, const std::filesystem::path& images) {
    return MessageOf<InputError>([&] { RequireOutsideScene(dir, posed, images); });
  };
  EXPECT_EQ(refusal(out, "images"), "");
  EXPECT_EQ(refusal(temp / "photos" / "out", ""), "");
  EXPECT_THAT(refusal(temp / "photos" / "left" / "out", ""), AllOf(HasSubstr("image folder"), HasSubstr("-o")));
  EXPECT_THAT(refusal(temp / "photos" / "out", temp / "photos"), HasSubstr("image folder"));
  EXPECT_THAT(refusal(temp / "photos", "../photos"), HasSubstr("image folder"));
  EXPECT_THAT(refusal(scene / "out", ""), HasSubstr("scene folder"));
}

TEST_F(WorkspaceTest, AFolderNameThatIsNotUtf8DoesNoHarm) {
  scene = temp / "sc\xE9ne";
  out = temp / "\xFFout";
  std::filesystem::create_directories(scene);
  { const Workspace workspace = Claim(); }
  EXPECT_EQ(ReadSavedRun(out).scene.filename(), "sc\xEF\xBF\xBDne");
  WriteText(out / "point_cloud.ply", "x");
  EXPECT_EQ(Refusal(), "") << "still the same scene";
}

TEST_F(WorkspaceTest, ForgetsThatAStageWasFinished) {
  Workspace workspace = Claim();
  workspace.MarkUndone("depth");  // never finished: nothing to forget
  workspace.MarkDone("depth", {{"key", "k"}, {"files", nlohmann::json::array()}});
  workspace.MarkDone("sfm", {{"key", "k"}, {"files", nlohmann::json::array()}});
  workspace.MarkUndone("depth");
  EXPECT_FALSE(workspace.IsDone("depth", "k"));
  EXPECT_TRUE(workspace.Record("depth").is_null());
  EXPECT_TRUE(workspace.IsDone("sfm", "k"));
}

TEST_F(WorkspaceTest, KeepsProposalFoldersApartFromTheRun) {
  const std::filesystem::path folder = temp / "proposals";
  std::filesystem::create_directories(out / "proposals");
  std::filesystem::create_directories(folder);
  EXPECT_EQ(MessageOf<InputError>([&] { RequireApart(out, folder); }), "");
  EXPECT_THAT(MessageOf<InputError>([&] { RequireApart(out, temp / "nowhere"); }), HasSubstr("is no folder"));
  EXPECT_THAT(MessageOf<InputError>([&] { RequireApart(out, out / "proposals"); }), HasSubstr("lies in the workspace"));
  EXPECT_THAT(MessageOf<InputError>([&] { RequireApart(folder / "out", folder); }), HasSubstr("never written to"));
  EXPECT_THAT(MessageOf<InputError>([&] { RequireApart(out, temp / "p\xff"); }), HasSubstr("not valid UTF-8"));
}

}  // namespace
}  // namespace oraclegs
