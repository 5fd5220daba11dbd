#include "oraclegs/workspace/part_store.h"

#include <gtest/gtest.h>
#include <sys/wait.h>
#include <unistd.h>

#include "oraclegs/core/atomic_file.h"
#include "oraclegs/core/error.h"
#include "oraclegs/core/files.h"
#include "support/temp_dir.h"

namespace oraclegs {
namespace {

namespace fs = std::filesystem;

class PartStoreTest : public testing::Test {
 protected:
  PartStore Store(const std::string& key = "key") { return {WorkspacePaths(temp.path()), "stage", key}; }

  void Make(size_t number, const std::string& text) {
    Store().Make(number, [&](const fs::path& folder) {
      WriteFileAtomically(folder / "images" / "b.txt", text);
      WriteFileAtomically(folder / "a.txt", text);
      return nlohmann::json{{"text", text}};
    });
  }

  TempDir temp;
};

TEST_F(PartStoreTest, MovesThePartIntoTheWorkspaceOnce) {
  Make(3, "one");
  EXPECT_TRUE(Store().Has(3));
  EXPECT_FALSE(Store().Has(2));
  const auto record = Store().Take(3);
  ASSERT_TRUE(record);
  EXPECT_EQ(record->at("text"), "one");
  EXPECT_EQ(ReadFile(temp / "a.txt"), "one");
  EXPECT_EQ(ReadFile(temp / "images" / "b.txt"), "one");
  EXPECT_FALSE(Store().Take(3));
  EXPECT_FALSE(fs::exists(temp / "parts" / "stage" / "3"));
}

TEST_F(PartStoreTest, ReplacesAnEarlierPartAndWhatLiesInTheWorkspace) {
  Make(0, "old");
  Make(0, "new");
  WriteFileAtomically(temp / "a.txt", "older");
  ASSERT_TRUE(Store().Take(0));
  EXPECT_EQ(ReadFile(temp / "a.txt"), "new");
}

TEST_F(PartStoreTest, HasNoPartsOfOtherInputs) {
  Make(0, "one");
  EXPECT_FALSE(Store("other").Has(0));
  EXPECT_FALSE(Store("other").Take(0));
  EXPECT_FALSE(fs::exists(temp / "a.txt"));
}

TEST_F(PartStoreTest, HasNoPartsThatWereNotFinished) {
  EXPECT_THROW(Store().Make(0,
                            [](const fs::path& folder) -> nlohmann::json {
                              WriteFileAtomically(folder / "a.txt", "half");
                              throw RunError("stopped");
                            }),
               RunError);
  EXPECT_FALSE(Store().Has(0));
  EXPECT_FALSE(Store().Take(0));
  EXPECT_TRUE(fs::is_empty(temp / "parts" / "stage"));
  Make(1, "one");
  for (const char* damage : {"{", "[]", "{\"key\": 3}"}) {
    WriteFileAtomically(temp / "parts" / "stage" / "1" / "part.json", damage);
    EXPECT_FALSE(Store().Take(1)) << damage;
  }
}

TEST_F(PartStoreTest, WhatAnotherProcessIsMakingStaysWhenLeftoversAreRemoved) {
  int ready[2], go[2];
  ASSERT_EQ(pipe(ready), 0);
  ASSERT_EQ(pipe(go), 0);
  const pid_t worker = fork();
  if (worker == 0) {
    close(go[1]);
    Store().Make(0, [&](const fs::path& folder) {
      WriteFileAtomically(folder / "a.txt", "half");
      char byte = 'x';
      if (write(ready[1], &byte, 1) != 1 || read(go[0], &byte, 1) < 0) _exit(1);
      return nlohmann::json::object();
    });
    _exit(0);
  }
  char byte = 0;
  ASSERT_EQ(read(ready[0], &byte, 1), 1);
  RemoveLeftovers(temp.path());  // as a run does that starts
  close(go[0]), close(go[1]), close(ready[0]), close(ready[1]);
  int status = -1;
  waitpid(worker, &status, 0);
  EXPECT_EQ(status, 0);
  ASSERT_TRUE(Store().Take(0));
  EXPECT_EQ(ReadFile(temp / "a.txt"), "half");
}

TEST_F(PartStoreTest, LeavesLinksBehind) {
  Make(0, "one");
  fs::create_symlink("/etc/passwd", temp / "parts" / "stage" / "0" / "link");
  ASSERT_TRUE(Store().Take(0));
  EXPECT_FALSE(fs::exists(temp / "link"));
}

TEST_F(PartStoreTest, IsNoPartWhereAFileIsInTheWay) {
  Make(0, "one");
  fs::create_directories(temp / "a.txt" / "folder");
  EXPECT_FALSE(Store().Take(0));
  EXPECT_FALSE(Store().Has(0));
}

TEST_F(PartStoreTest, CanBeCleared) {
  Make(0, "one");
  Make(1, "one");
  Store("other").Clear();
  EXPECT_FALSE(Store().Has(0));
  EXPECT_FALSE(fs::exists(temp / "parts" / "stage"));
}

}  // namespace
}  // namespace oraclegs
