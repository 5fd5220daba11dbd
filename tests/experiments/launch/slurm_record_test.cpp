#include "oraclegs/experiments/launch/slurm_record.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "support/errors.h"
#include "support/temp_dir.h"

namespace oraclegs {
namespace {

TEST(SlurmRecord, ComesBackAsItWasWritten) {
  const TempDir dir;
  SlurmRecord record = ReadSlurmRecord(dir.path());
  EXPECT_NE(record.name, ReadSlurmRecord(dir.path()).name) << "a new one has a name of its own";
  record.cluster = "alps";
  record.submissions = {{"12", "0000", {{"garden/ours", "ab", 1, true, false}, {"b", "cd", 0, false, true}}},
                        {"", "0001", {}}};
  WriteSlurmRecord(dir.path(), record);
  EXPECT_EQ(ReadSlurmRecord(dir.path()), record);
}

TEST(SlurmRecord, SaysThatItIsDamaged) {
  const TempDir dir;
  for (const char* text : {"{}", "[]", "{\"name\": 3, \"cluster\": \"\", \"submissions\": []}", "{"}) {
    WriteText(dir / "slurm.json", text);
    EXPECT_THAT(MessageOf<InputError>([&] { ReadSlurmRecord(dir.path()); }), testing::HasSubstr("slurm.json")) << text;
  }
}

TEST(SlurmRecord, TheDigestKnowsWhereWordsEnd) {
  const auto digest = [](std::vector<std::string> command) {
    return SlurmCommandDigest({.name = {}, .command = std::move(command), .log = {}});
  };
  EXPECT_EQ(digest({"a", "b"}), digest({"a", "b"}));
  EXPECT_NE(digest({"a", "b"}), digest({"ab"}));
  EXPECT_NE(digest({"a", ""}), digest({"a"}));
}

}  // namespace
}  // namespace oraclegs
