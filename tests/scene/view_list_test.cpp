#include "oraclegs/scene/view_list.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "oraclegs/core/error.h"
#include "oraclegs/core/files.h"
#include "support/errors.h"
#include "support/temp_dir.h"

namespace oraclegs {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;

class ViewListFile : public ::testing::Test {
 protected:
  std::string Write(const std::string& text) {
    const auto path = dir_.path() / "views.txt";
    WriteFileAtomically(path, text);
    return "@" + path.string();
  }
  std::string Error(const std::string& text) {
    const std::string list = Write(text);
    return MessageOf<InputError>([&] { ExpandViewList(list, "train"); });
  }

  TempDir dir_;
};

TEST_F(ViewListFile, LeavesOtherListsAlone) { EXPECT_EQ(ExpandViewList("a.jpg, :3", "train"), "a.jpg, :3"); }

TEST_F(ViewListFile, HoldsOneNameALine) {
  EXPECT_EQ(ExpandViewList(Write("# the split of a paper\n\n a.jpg\r\n:3\n"), "train"), "a.jpg,:3");
}

TEST_F(ViewListFile, MayBeginWithAByteOrderMark) {
  EXPECT_EQ(ExpandViewList(Write("\xEF\xBB\xBF"
                                 "a.jpg\r\n"),
                           "train"),
            "a.jpg");
}

TEST_F(ViewListFile, MayBeARunsSplit) {
  const std::string split = Write("{\"train\": [\"a.jpg\", \"b.jpg\"], \"test\": [\"c.jpg\"]}");
  EXPECT_EQ(ExpandViewList(split, "train"), "a.jpg,b.jpg");
  EXPECT_EQ(ExpandViewList(split, "test"), "c.jpg");
}

TEST_F(ViewListFile, NamesWhatIsWrong) {
  EXPECT_THAT(Error(""), AllOf(HasSubstr("views.txt"), HasSubstr("names no view")));
  EXPECT_THAT(Error("# nothing\n"), HasSubstr("names no view"));
  EXPECT_THAT(Error("a,b\n"), HasSubstr("holds a comma"));
  EXPECT_THAT(Error("{\"train\": ["), HasSubstr("views.txt"));
  EXPECT_THAT(Error("{\"test\": [\"a\"]}"), HasSubstr("no list \"train\""));
  EXPECT_THAT(Error("{\"train\": [1]}"), HasSubstr("no list \"train\""));
  EXPECT_THAT(Error("\xff\xfe"), HasSubstr("UTF-8"));
  EXPECT_THAT(MessageOf<InputError>([] { ExpandViewList("@/nowhere/views.txt", "train"); }),
              HasSubstr("/nowhere/views.txt"));
}

}  // namespace
}  // namespace oraclegs
