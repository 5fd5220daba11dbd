#include "oraclegs/output/view/view_source.h"

#include <nlohmann/json.hpp>

#include "oraclegs/core/folder_lock.h"
#include "oraclegs/formats/codecs.h"
#include "oraclegs/formats/zip_archive.h"
#include "oraclegs/output/info.h"
#include "run/trained.h"

namespace oraclegs {
namespace {

using testing::Contains;
using testing::HasSubstr;
namespace fs = std::filesystem;

class ViewSourceTest : public TrainedTest {
 protected:
  /// A workspace of our own to spoil.
  fs::path Copy(const std::string& name) const {
    fs::copy(*temp / "out", *temp / name, fs::copy_options::recursive);
    fs::remove_all(*temp / name / "report");
    return *temp / name;
  }
};

TEST_F(ViewSourceTest, AFinishedRunIsServedAsItIs) {
  const fs::path out = Copy("finished");
  WriteText(out / "report" / "run.json", R"({"finished": true, "splat": {"url": "report/splat.spz"}})");
  WriteText(out / "report" / "splat.spz", "x");
  const ViewSource source(out, recorder.AsListener());
  EXPECT_EQ(source.root(), out);
  EXPECT_EQ(source.what(), "a finished run");
  EXPECT_TRUE(recorder.warnings.empty() && recorder.notes.empty());
}

TEST_F(ViewSourceTest, WithoutAReportTheSplatIsShown) {
  const fs::path out = Copy("older");
  fs::path shown;
  {
    const ViewSource source(out, recorder.AsListener());
    shown = source.root();
    EXPECT_NE(shown, out);
    EXPECT_TRUE(fs::exists(shown / "splat.spz"));
    EXPECT_THAT(recorder.notes, Contains(HasSubstr("`oraclegs reconstruct`")));
  }
  EXPECT_FALSE(fs::exists(shown));
}

TEST_F(ViewSourceTest, ADamagedReportIsWarnedOf) {
  const fs::path out = Copy("damaged");
  WriteText(out / "report" / "run.json", R"({"splat": {"ur)");
  ViewSource source(out, recorder.AsListener());
  EXPECT_THAT(recorder.warnings, Contains(HasSubstr("run.json: is damaged")));
  EXPECT_TRUE(fs::exists(source.root() / "splat.spz"));
  WriteText(out / "report" / "run.json", R"({"finished": true, "splat": {"url": "report/splat.spz"}})");
  ViewSource again(out, recorder.AsListener());
  EXPECT_THAT(recorder.warnings, Contains(HasSubstr("splat.spz: is missing")));
}

TEST_F(ViewSourceTest, AFolderOfSogIsASplat) {
  const Gaussians splat = ReadGaussianPly(*temp / "out" / "point_cloud.ply").gaussians;
  const fs::path folder = *temp / "sog";
  fs::create_directory(folder);
  for (const auto& [name, bytes] : ReadZip(EncodeSog(splat, 1), 20, "x.sog")) WriteText(folder / name, bytes);
  for (const fs::path& named : {folder, folder / "meta.json"}) {
    const ViewSource source(named, recorder.AsListener());
    EXPECT_TRUE(fs::exists(source.root() / "splat.spz"));
    EXPECT_EQ(Describe(named, false, Silent()).at("gaussians"), splat.size());
  }
}

TEST_F(ViewSourceTest, ARunThatGoesOnIsServed) {
  const fs::path out = Copy("going");
  const FolderLock lock(out / "live");
  const ViewSource source(out, recorder.AsListener());
  EXPECT_EQ(source.root(), out);
  EXPECT_EQ(source.what(), "a run that goes on");
}

TEST_F(ViewSourceTest, AnUnfinishedOneSaysWhatThereIs) {
  const fs::path out = Copy("unfinished");
  fs::remove(out / "point_cloud.ply");
  WriteText(out / "live" / "state.json", R"({"state": "running", "lock": true})");
  EXPECT_EQ(ViewSource(out, recorder.AsListener()).what(), "a run without a splat (interrupted)");
  EXPECT_THAT(recorder.notes, Contains(HasSubstr("no trained splat yet")));
  fs::remove_all(out / "live");
  EXPECT_EQ(ViewSource(out, Silent()).what(), "a workspace without a splat");
}

TEST_F(ViewSourceTest, ASplatFileIsShown) {
  const fs::path ply = *temp / "out" / "point_cloud.ply";
  EXPECT_EQ(ViewSource(ply, Silent()).what(), ply.string());
}

TEST_F(ViewSourceTest, AnythingElseIsRefused) {
  const auto message = [](const fs::path& path) { return MessageOf<InputError>([&] { ViewSource(path, Silent()); }); };
  EXPECT_THAT(message(*temp / "missing"), HasSubstr("does not exist"));
  EXPECT_THAT(message(*temp / "scene"), HasSubstr("holds no run of oraclegs"));
  WriteText(*temp / "bad.ply", "ply\nnonsense");
  EXPECT_THAT(message(*temp / "bad.ply"), HasSubstr("bad.ply"));
  WriteText(*temp / "a.txt", "");
  EXPECT_THROW(ViewSource(*temp / "a.txt", Silent()), UsageError);
  const fs::path out = Copy("spoilt");
  WriteText(out / "options.json", "{");
  EXPECT_THAT(message(out), HasSubstr("options.json"));
}

}  // namespace
}  // namespace oraclegs
