#include "oraclegs/formats/usda_text.h"

#include "support/errors.h"

namespace oraclegs {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;

constexpr const char* kHead = "#usda 1.0\n";

template <class F>
std::string ErrorIn(const std::string& behind, F&& read) {
  const std::string text = kHead + behind;
  return MessageOf<InputError>([&] {
    UsdaText usda(text, "f");
    read(usda);
  });
}

TEST(UsdaText, WantsTextOfVersionOne) {
  const auto error = [](const char* text) { return MessageOf<InputError>([&] { UsdaText(text, "f"); }); };
  EXPECT_THAT(error("PXR-USDC\1"), HasSubstr("f: is USD's binary format"));
  EXPECT_THAT(error("#usda 2.0"), HasSubstr("f: does not begin with '#usda 1.0'"));
  EXPECT_THAT(error(""), HasSubstr("is it a text file of USD?"));
}

TEST(UsdaText, PassesBlanksAndComments) {
  const std::string text = std::string(kHead) + " # one\n // two \n/* three\n */ ; word /**/ next\nlast";
  UsdaText usda(text, "f");
  EXPECT_FALSE(usda.AtEnd());
  EXPECT_EQ(usda.Word(), "word");
  EXPECT_TRUE(usda.WordFollows());
  EXPECT_EQ(usda.Word(), "next");
  EXPECT_FALSE(usda.WordFollows()) << "it stands on the next line";
  EXPECT_FALSE(usda.TakeOnLine('l'));
  EXPECT_EQ(usda.Word(), "last");
  EXPECT_TRUE(usda.AtEnd());
}

TEST(UsdaText, TakesWordsWithTheirNamespacesAndBrackets) {
  const std::string text = std::string(kHead) + "point3f[] radiance:sphericalHarmonicsDegree.timeSamples";
  UsdaText usda(text, "f");
  EXPECT_EQ(usda.Word(), "point3f[]");
  EXPECT_EQ(usda.Word(), "radiance:sphericalHarmonicsDegree.timeSamples");
}

TEST(UsdaText, TakesTextsInAnyQuotes) {
  const std::string text = std::string(kHead) + R"("a" 'b"' """c "d" 
" e""" "f\"g" ["h", 'i'] 'j')";
  UsdaText usda(text, "f");
  EXPECT_EQ(usda.Quoted(), "a");
  EXPECT_EQ(usda.Quoted(), "b\"");
  EXPECT_EQ(usda.Quoted(), "c \"d\" \n\" e");
  EXPECT_EQ(usda.Quoted(), "f\\\"g");
  EXPECT_THAT(usda.QuotedList(), ElementsAre("h", "i"));
  EXPECT_THAT(usda.QuotedList(), ElementsAre("j"));
  EXPECT_TRUE(usda.AtEnd());
}

TEST(UsdaText, SkipsAnyValue) {
  for (const char* value : {"1.5e-3", "-inf", "None", "\"a ] \"", "@a]b@", "@@@a@b@@@", "</A/B.c>", "[1, 2]",
                            "((1), (2))", "[]", "{ string a = \"}\"\n dictionary b = { int[] c = [1] } }",
                            "{ 0: [(1, 2)], 1: None, }", "[@a@ (offset = 1), </b>]", "[ # ]\n 1]"}) {
    const std::string text = std::string(kHead) + value + " next";
    UsdaText usda(text, "f");
    usda.SkipValue();
    EXPECT_EQ(usda.Word(), "next") << value;
  }
  const std::string deep = kHead + std::string(100000, '[') + std::string(100000, ']');
  UsdaText usda(deep, "f");
  usda.SkipValue();
  EXPECT_TRUE(usda.AtEnd());
}

TEST(UsdaText, ReadsNumbers) {
  const std::string text =
      std::string(kHead) + "[(1, -2.5e1), (inf,1e-50),\n] [1,2,3,] -7 ( (1, 2), (3, 4) ) [] (5, 6)";
  UsdaText usda(text, "f");
  EXPECT_THAT(usda.Numbers<float>(2), ElementsAre(1, -25, INFINITY, 0));
  EXPECT_THAT(usda.Numbers<float>(1), ElementsAre(1, 2, 3));
  EXPECT_THAT(usda.Numbers<double>(1), ElementsAre(-7));
  EXPECT_THAT(usda.Numbers<double>(2), ElementsAre(1, 2, 3, 4));
  EXPECT_THAT(usda.Numbers<float>(3), ElementsAre());
  EXPECT_THAT(usda.Numbers<float>(2), ElementsAre(5, 6));
  EXPECT_TRUE(usda.AtEnd());
}

TEST(UsdaText, NamesTheLineOfWhatIsDamaged) {
  const auto numbers = [](int components) { return [components](UsdaText& usda) { usda.Numbers<float>(components); }; };
  EXPECT_THAT(ErrorIn("\n[1, x]", numbers(1)), HasSubstr("f:3: 'x]' is no number; export it again"));
  EXPECT_THAT(ErrorIn("[(1, 2)]", numbers(3)), HasSubstr("2 numbers are in parentheses, expected 3"));
  EXPECT_THAT(ErrorIn("[(1, 2)]", numbers(1)), HasSubstr("stands where a number was expected"));
  EXPECT_THAT(ErrorIn("[1, 2]", numbers(2)), HasSubstr("stands where '(' before 2 numbers was expected"));
  EXPECT_THAT(ErrorIn("[(1, 2]", numbers(2)), HasSubstr("']' closes what is not open"));
  EXPECT_THAT(ErrorIn("[[[[1", numbers(1)), HasSubstr("nested too deep"));
  EXPECT_THAT(ErrorIn("[1, 2", numbers(1)), HasSubstr("the text ends within numbers"));
  EXPECT_THAT(ErrorIn("1e9999x", numbers(1)), HasSubstr("is no number"));
  EXPECT_THAT(ErrorIn("None", numbers(1)), HasSubstr("'None' is no number"));
  const auto skip = [](UsdaText& usda) { usda.SkipValue(); };
  EXPECT_THAT(ErrorIn("[ (1 ]", skip), HasSubstr("']' closes what is not open"));
  EXPECT_THAT(ErrorIn("[ 1", skip), HasSubstr("the text ends within a value"));
  EXPECT_THAT(ErrorIn("=", skip), HasSubstr("'=' stands where a value was expected"));
  EXPECT_THAT(ErrorIn("@a", skip), HasSubstr("a path that begins here does not end"));
  EXPECT_THAT(ErrorIn("<a", skip), HasSubstr("a path that begins here does not end"));
  EXPECT_THAT(ErrorIn("/* a", skip), HasSubstr("a comment that begins here does not end"));
  EXPECT_THAT(ErrorIn("\"a\\\"", skip), HasSubstr("a text that begins here does not end"));
  EXPECT_THAT(ErrorIn("=", [](UsdaText& usda) { usda.Word(); }), HasSubstr("'=' stands where a name was expected"));
  EXPECT_THAT(ErrorIn("a", [](UsdaText& usda) { usda.Quoted(); }), HasSubstr("a text in quotes was expected"));
  EXPECT_THAT(ErrorIn("['a'", [](UsdaText& usda) { usda.QuotedList(); }), HasSubstr("a text in quotes was expected"));
}

}  // namespace
}  // namespace oraclegs
