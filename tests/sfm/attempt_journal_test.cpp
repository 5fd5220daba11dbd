#include "oraclegs/sfm/attempt_journal.h"

#include <gtest/gtest.h>

#include <filesystem>
#include <nlohmann/json.hpp>

#include "oraclegs/core/files.h"
#include "support/temp_dir.h"

namespace oraclegs {
namespace {

TEST(AttemptJournal, SurvivesItsFile) {
  const TempDir dir;
  EXPECT_TRUE(ReadAttemptJournal(dir.path()).steps.empty());
  AttemptJournal journal;
  journal.steps = {"usual features, extracted", "usual features, matched"};
  journal.records = {{"usual features", "strict", 5, 321, .62, 7.5, true}};
  journal.model = "models0/0";
  journal.database = "features0.db";
  journal.features = "usual features";
  journal.left_out = {"a.jpg"};
  journal.folders = 3;
  WriteAttemptJournal(journal, dir.path());
  const AttemptJournal read = ReadAttemptJournal(dir.path());
  EXPECT_EQ(read.steps, journal.steps);
  ASSERT_EQ(read.records.size(), 1u);
  EXPECT_EQ(RecordToJson(read.records[0]), RecordToJson(journal.records[0]));
  EXPECT_EQ(read.left_out, journal.left_out);
  EXPECT_EQ(read.model, journal.model);
  EXPECT_EQ(read.database, journal.database);
  EXPECT_EQ(read.features, journal.features);
  EXPECT_EQ(read.folders, 3);
}

TEST(AttemptJournal, IsEmptyWhenDamaged) {
  const TempDir dir;
  AttemptJournal journal;
  journal.steps = {"matched"};
  WriteAttemptJournal(journal, dir.path());
  for (const auto& entry : std::filesystem::directory_iterator(dir.path())) WriteFileAtomically(entry.path(), "{\"st");
  EXPECT_TRUE(ReadAttemptJournal(dir.path()).steps.empty());
}

}  // namespace
}  // namespace oraclegs
