#include "oraclegs/app/library.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "oraclegs/core/error.h"
#include "support/errors.h"
#include "support/temp_dir.h"

namespace oraclegs {
namespace {

using testing::HasSubstr;
using testing::SizeIs;

namespace fs = std::filesystem;

class LibraryTest : public testing::Test {
 protected:
  TempDir dir;
  Library library{dir / "OracleGS"};
};

TEST_F(LibraryTest, GivesEachProjectAFolderForItsOwnerAlone) {
  const Project first = library.Create("Zoë's Garden!"), second = library.Create("zo s garden"),
                dots = library.Create("../..");
  EXPECT_EQ(first.paths.root().filename(), "zo-s-garden");
  EXPECT_EQ(second.paths.root().filename(), "zo-s-garden-2");
  EXPECT_EQ(dots.paths.root().filename(), "splat");
  EXPECT_EQ(first.record.name, "Zoë's Garden!");
  EXPECT_EQ(fs::status(first.paths.root()).permissions(), fs::perms::owner_all);
  EXPECT_THAT(library.Projects(), SizeIs(3));
  EXPECT_EQ(library.Find(second.id).value().paths.root(), second.paths.root());
  EXPECT_THAT(first.id, testing::MatchesRegex("[0-9a-f]+"));
}

TEST_F(LibraryTest, ShowsRunsOfACommandLineAndNothingElse) {
  WriteText(library.root() / "by-hand" / "options.json", "{}");
  WriteText(library.root() / "by-hand" / "stages.json", "{}");
  WriteText(library.root() / "holiday" / "a.jpg", "photo");
  WriteText(library.root() / ".hidden" / "project.json", "{}");
  WriteText(dir / "outside" / "project.json", "{}");
  fs::create_directory_symlink(dir / "outside", library.root() / "link");
  const std::vector<Project> projects = library.Projects();
  ASSERT_THAT(projects, SizeIs(1));
  EXPECT_TRUE(projects[0].is_foreign);
  EXPECT_EQ(projects[0].record.name, "by-hand");
  EXPECT_EQ(projects[0].splat(), library.root() / "by-hand");
  EXPECT_THROW(library.Update(projects[0].id, [](ProjectRecord*) {}), InputError);
  for (const char* id : {"", "..", "link", "by-hand", "0123456789abcdef"}) EXPECT_FALSE(library.Find(id)) << id;
  EXPECT_FALSE(library.Find(IdOf("link")));
}

TEST_F(LibraryTest, ChangesARecord) {
  const Project project = library.Create("a");
  library.Update(project.id, [](ProjectRecord* record) { record->name = "b", record->queued = 3; });
  const Project changed = library.Find(project.id).value();
  EXPECT_EQ(changed.record.name, "b");
  EXPECT_EQ(changed.record.queued, 3);
}

TEST_F(LibraryTest, RemovesForGood) {
  const Project project = library.Create("a");
  WriteText(project.paths.photos() / "1.jpg", "x");
  library.Remove(project);
  EXPECT_FALSE(fs::exists(project.paths.root()));
  EXPECT_FALSE(library.Find(project.id));
}

TEST_F(LibraryTest, IsShownByOneAppAlone) {
  EXPECT_THAT(MessageOf<RunError>([&] { Library second(dir / "OracleGS"); }), HasSubstr("another OracleGS"));
}

TEST_F(LibraryTest, KnowsTheSpaceThatIsLeft) { EXPECT_GT(library.FreeBytes(), 0u); }

TEST(Library, SaysWhereItCannotBe) {
  const TempDir dir;
  WriteText(dir / "file", "");
  EXPECT_THAT(MessageOf<RunError>([&] { Library library(dir / "file"); }), HasSubstr("file"));
}

}  // namespace
}  // namespace oraclegs
