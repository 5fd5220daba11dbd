#include "oraclegs/sfm/best_model.h"

#include <gtest/gtest.h>

#include "support/temp_dir.h"

namespace oraclegs {
namespace {

Candidate CandidateOf(const std::filesystem::path& model, int images, int points) {
  Candidate candidate{model, model / "features.db", {}, {}};
  candidate.set.name = "usual features";
  for (int i = 0; i < images; ++i) candidate.quality.images[std::to_string(i)] = {points, 9};
  candidate.quality.points = points;
  candidate.quality.parallax_degrees = 9;
  return candidate;
}

TEST(BestModel, TakesTheBetterOneAndSaysSoInTheJournal) {
  const TempDir dir;
  const Listener silent = Silent();
  const ColmapRunner colmap(dir.path(), silent, "register");
  BestModel best(dir.path());
  EXPECT_EQ(best.registered(), 0);
  AttemptRecord first{"usual features", "strict"}, second{"usual features", "relaxed"},
      third{"usual features", "third"};
  best.Consider(CandidateOf(dir / "models0" / "0", 3, 100), colmap, &first);
  best.journal().records.push_back(first);
  EXPECT_TRUE(first.kept);
  best.Consider(CandidateOf(dir / "models1" / "0", 2, 900), colmap, &second);
  EXPECT_FALSE(second.kept) << "fewer images";
  EXPECT_EQ(second.points, 900) << "it is noted";
  best.journal().records.push_back(second);
  best.Consider(CandidateOf(dir / "models2" / "0", 4, 100), colmap, &third);
  EXPECT_TRUE(third.kept);
  EXPECT_FALSE(best.journal().records[0].kept) << "one is kept";
  EXPECT_EQ(best.registered(), 4);
  EXPECT_EQ(best.journal().model, "models2/0");
  EXPECT_EQ(best.journal().features, "usual features");
}

TEST(BestModel, BeginsAnewWhereTheModelOfTheJournalIsGone) {
  const TempDir dir;
  AttemptJournal journal;
  journal.steps = {"usual features"};
  journal.model = "models0/0";
  WriteAttemptJournal(journal, dir.path());
  BestModel best(dir.path());
  best.Resume();
  EXPECT_EQ(best.registered(), 0);
  EXPECT_TRUE(best.journal().steps.empty());
}

}  // namespace
}  // namespace oraclegs
