#include "oraclegs/datasets/pose_files.h"

#include "support/event_recorder.h"
#include "support/temp_dir.h"

#include <gmock/gmock.h>

namespace oraclegs {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;

TEST(FilesThatEnd, ListsAFolderItself) {
  TempDir temp;
  for (const char* name : {"b.xml", "a.xml", ".c.xml", "d.xml.txt", "below/e.xml"}) WriteText(temp / name, "");
  EXPECT_THAT(FilesThatEnd(temp.path(), ".xml"), ElementsAre(temp / "a.xml", temp / "b.xml"));
  EXPECT_THAT(FilesThatEnd(temp / "absent", ".xml"), IsEmpty());
}

TEST(HeadOfPoseFile, DropsAByteOrderMark) {
  TempDir temp;
  WriteText(temp / "a", "\xef\xbb\xbf#name");
  EXPECT_EQ(HeadOfPoseFile(temp / "a"), "#name");
  WriteText(temp / "b", std::string(100000, 'x'));
  EXPECT_EQ(HeadOfPoseFile(temp / "b").size(), 65536u);
}

TEST(ReportUnplaced, IsSilentWhereAllArePlaced) {
  EventRecorder events;
  ReportUnplaced("F", {}, events.AsListener());
  EXPECT_THAT(events.warnings, IsEmpty());
  ReportUnplaced("F", {"a", "b"}, events.AsListener());
  EXPECT_THAT(events.warnings, ElementsAre(HasSubstr("F: has no pose for 2 photos and leaves them out: a, b")));
}

}  // namespace
}  // namespace oraclegs
