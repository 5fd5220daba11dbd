#include "oraclegs/proposers/proposer_rows.h"

#include <gmock/gmock.h>

namespace oraclegs {
namespace {

TEST(ProposerRows, HaveWordsOfTheirOwnAndOneThatStandsIn) {
  std::vector<std::string> words;
  int stand_ins = 0;
  for (const ProposerRow& row : ProposerRows()) {
    words.push_back(row.word);
    EXPECT_TRUE(row.make && row.undo) << row.word;
    EXPECT_TRUE(row.can_hold_out || row.sees_anything) << row.word;
    stand_ins += row.stands_in ? 1 : 0;
    EXPECT_TRUE(row.can_hold_out || !row.stands_in) << row.word;
  }
  std::vector<std::string> known = {kNoneWord};
  for (const std::string& word : words) known.push_back(word);
  EXPECT_THAT(ProposerWords(), testing::UnorderedElementsAreArray(known)) << "help and settings know the rows";
  EXPECT_EQ(stand_ins, 1);
}

}  // namespace
}  // namespace oraclegs
