#include "oraclegs/output/splat_folder.h"

#include <gmock/gmock.h>

#include "oraclegs/core/error.h"
#include "oraclegs/core/files.h"
#include "support/errors.h"
#include "support/temp_dir.h"

namespace oraclegs {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;

void Touch(const std::filesystem::path& path) {
  std::filesystem::create_directories(path.parent_path());
  WriteFileAtomically(path, "x");
}

std::vector<std::string> NamesOf(const std::vector<SplatJob>& jobs) {
  std::vector<std::string> names;
  for (const SplatJob& job : jobs) names.push_back(job.from.filename().string() + ">" + job.to.filename().string());
  return names;
}

TEST(SplatJobsOf, AreTheSplatsOfAFolderByName) {
  const TempDir dir;
  for (const char* name : {"b.ply", "a.x.compressed.ply", "c.ksplat", ".hidden.ply", "d.jpg", "below/e.ply",
                           "run/options.json", "run/point_cloud.ply"}) {
    Touch(dir / name);
  }
  const auto jobs = SplatJobsOf(dir.path(), dir / "out", "sog");
  EXPECT_THAT(NamesOf(jobs), ElementsAre("a.x.compressed.ply>a.x.sog", "b.ply>b.sog", "c.ksplat>c.sog", "run>run.sog"));
  EXPECT_EQ(jobs[0].to, dir / "out" / "a.x.sog");
}

TEST(SplatJobsOf, LeavesWhatIsInPlaceAlready) {
  const TempDir dir;
  for (const char* name : {"a.ply", "a.spz", "b.SPZ"}) Touch(dir / name);
  EXPECT_THAT(NamesOf(SplatJobsOf(dir.path(), dir.path(), ".spz")), ElementsAre("a.ply>a.spz", "b.SPZ>b.spz"));
  EXPECT_THAT(MessageOf<UsageError>([&] { SplatJobsOf(dir.path(), dir / "out", ".spz"); }),
              HasSubstr("a.ply and " + (dir / "a.spz").string() + " would both become"));
}

TEST(SplatJobsOf, RefusesWhatHoldsNoneAndUnknownEnds) {
  const TempDir dir;
  EXPECT_THAT(MessageOf<InputError>([&] { SplatJobsOf(dir.path(), dir / "out", "spz"); }),
              HasSubstr("holds no splat to convert"));
  EXPECT_THAT(MessageOf<InputError>([&] { SplatJobsOf(dir / "none", dir / "out", "spz"); }),
              HasSubstr("cannot be read"));
  EXPECT_THAT(MessageOf<UsageError>([&] { SplatJobsOf(dir.path(), dir / "out", ""); }), HasSubstr("not given"));
  EXPECT_THAT(MessageOf<UsageError>([&] { SplatJobsOf(dir.path(), dir / "out", "ksplat"); }),
              HasSubstr("--format is ksplat: it must be one of .ply"));
}

TEST(SplatJobOf, KeepsTheNameOfAFileOrFolder) {
  const TempDir dir;
  std::filesystem::create_directories(dir / "scene.v2");
  EXPECT_EQ(SplatJobOf(dir / "scene.v2/", "out", "glb").to, "out/scene.v2.glb");
  EXPECT_EQ(SplatJobOf("a/b.spz.glb", "out", "compressed.ply").to, "out/b.compressed.ply");
}

}  // namespace
}  // namespace oraclegs
