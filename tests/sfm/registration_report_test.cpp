#include "oraclegs/sfm/registration_report.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

namespace oraclegs {
namespace {

using testing::AllOf;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;
using testing::Not;
using testing::StartsWith;

ViewReport MakeView(const std::string& name, int features, std::vector<Neighbor> neighbors = {}) {
  ViewReport view;
  view.name = name;
  view.features = features;
  view.neighbors = std::move(neighbors);
  return view;
}

/// a and b are registered; the rest of `others` is not.
RegistrationReport ReportWith(std::vector<ViewReport> others) {
  std::vector<ViewReport> views{MakeView("a", 4000, {{"b", 300, false}}), MakeView("b", 5000, {{"a", 300, false}})};
  for (ViewReport& view : others) views.push_back(std::move(view));
  AttemptResult result;
  result.best.images = {{"a", {200, 6.5}}, {"b", {200, 6.5}}};
  result.best.points = 200;
  result.best.parallax_degrees = 6.5;
  result.attempts = {{"usual features", "strict", 2, 200, .4, 6.5, true}};
  return MakeReport(std::move(views), result);
}

TEST(MakeReport, GivesParallaxOfRegisteredViews) {
  const RegistrationReport report = ReportWith({});
  EXPECT_EQ(report.registered(), 2);
  EXPECT_EQ(report.views[0].status, ViewStatus::kRegistered);
  EXPECT_EQ(report.views[0].parallax_degrees, 6.5);
  EXPECT_EQ(report.views[0].points, 200);
  EXPECT_EQ(report.views[0].advice, "");
  EXPECT_THAT(report.warnings, IsEmpty());
}

TEST(MakeReport, ExplainsMissingViews) {
  ViewReport copy = MakeView("z-copy", 0);
  copy.same_as = "a";
  const RegistrationReport report = ReportWith({MakeView("c-black", 12), MakeView("d-alone", 3000),
                                                MakeView("e-far", 3000, {{"a", 16, false}, {"b", 22, false}}),
                                                MakeView("f-rotated", 3000, {{"b", 400, true}, {"a", 20, false}}),
                                                MakeView("g-odd", 3000, {{"a", 90, true}, {"b", 60, false}}), copy});
  const auto& p = report.views;
  EXPECT_EQ(p[2].status, ViewStatus::kFewFeatures);
  EXPECT_THAT(p[2].advice, HasSubstr("only 12 features: blurred"));
  EXPECT_EQ(p[3].status, ViewStatus::kNoMatches);
  EXPECT_EQ(p[3].advice,
            "take one between b and d-alone, and one between it and a, or leave it out if it shows another place");
  EXPECT_EQ(p[4].status, ViewStatus::kFewMatches);
  EXPECT_EQ(p[4].neighbors[0].name, "b") << "the best is first";
  EXPECT_EQ(p[4].advice, "take one between b and e-far");
  EXPECT_EQ(p[5].status, ViewStatus::kPureRotation);
  EXPECT_EQ(p[5].advice, "move sideways, do not only turn the camera");
  EXPECT_EQ(p[6].status, ViewStatus::kDoesNotFit);
  EXPECT_EQ(p[7].status, ViewStatus::kDuplicate);
  EXPECT_THAT(report.warnings,
              ElementsAre("z-copy is the same photo as a and is left out",
                          AllOf(StartsWith("registered 2 of 8 photos; not registered: c-black (12 features"),
                                HasSubstr("d-alone (no matches with any other)"),
                                HasSubstr("e-far (only 22 matches with b, fewer with others)"), HasSubstr("1 more"),
                                HasSubstr("take it again sharp"))));
  for (const std::string& warning : report.warnings) EXPECT_THAT(warning, Not(HasSubstr("\n")));
}

TEST(MakeReport, SaysWhichPhotoHasNoCameraThatCanBeRight) {
  AttemptResult result;
  result.best.images = {{"a", {200, 6.5}}, {"b", {200, 6.5}}};
  result.left_out = {"odd"};
  const RegistrationReport report =
      MakeReport({MakeView("a", 4000), MakeView("b", 4000), MakeView("odd", 4000, {{"a", 90, false}})}, result);
  EXPECT_EQ(report.views[2].status, ViewStatus::kNoCamera);
  EXPECT_THAT(WhyMissing(report), HasSubstr("odd (its matches ask for a lens that there is not"));
  EXPECT_EQ(ReportToJson(report).at("views")[2].at("status"), "no_camera");
}

TEST(MakeReport, DoubtsAPhotoThatSharesThingsFromTooFarOnly) {
  AttemptResult result;
  result.best.parallax_degrees = 20;
  result.best.images = {{"a", {200, 65, 20}}, {"b", {200, 65, 20}}, {"far", {110, 65, 63}}};
  const RegistrationReport report =
      MakeReport({MakeView("a", 4000), MakeView("b", 4000), MakeView("far", 4000, {{"b", 90, false}})}, result);
  ASSERT_EQ(report.warnings.size(), 1u);
  EXPECT_THAT(report.warnings[0],
              HasSubstr("the poses are doubtful: far sees what it shares with others from 63 degrees"));
  EXPECT_THAT(report.warnings[0], HasSubstr("between it and b"));
}

TEST(MakeReport, NamesPhotosOfAnotherPlace) {
  const RegistrationReport report = ReportWith(
      {MakeView("x", 3000, {{"y", 200, false}, {"b", 17, false}}), MakeView("y", 3000, {{"x", 200, false}})});
  EXPECT_EQ(report.views[2].status, ViewStatus::kElsewhere);
  EXPECT_EQ(report.views[3].status, ViewStatus::kElsewhere);
  EXPECT_EQ(report.views[2].advice, "take photos between it and b, or leave it out if it shows another place");
  EXPECT_THAT(report.warnings,
              ElementsAre(HasSubstr("x (200 matches with y, but hardly any with a registered photo)")));
}

TEST(MakeReport, WarnsOfWeakParallax) {
  AttemptResult result;
  result.best.images = {{"a", {200, .4}}, {"b", {200, .4}}};
  result.best.parallax_degrees = .4;
  const RegistrationReport report = MakeReport({MakeView("a", 4000), MakeView("b", 4000)}, result);
  EXPECT_THAT(report.views[0].advice, HasSubstr("to the side"));
  EXPECT_THAT(report.warnings, ElementsAre(AllOf(HasSubstr("nearly one point"), HasSubstr("0.40 degrees"))));
}

TEST(TakenFromOnePoint, RequiresPureRotationOfEveryPair) {
  const AttemptResult none;
  const auto report = [&](bool pure_rotation) {
    return MakeReport(
        {MakeView("a", 4000, {{"b", 300, true}}), MakeView("b", 4000, {{"a", 300, true}, {"c", 99, pure_rotation}}),
         MakeView("c", 4000, {{"b", 99, pure_rotation}, {"a", 12, false}})},
        none);
  };
  EXPECT_TRUE(TakenFromOnePoint(report(true))) << "twelve matches are chance";
  EXPECT_FALSE(TakenFromOnePoint(report(false)));
  EXPECT_FALSE(TakenFromOnePoint(MakeReport({MakeView("a", 9), MakeView("b", 9)}, none))) << "nothing is known";
}

TEST(WhyMissing, NamesFiveAndCountsTheRest) {
  std::vector<ViewReport> black;
  for (int i = 0; i < 7; ++i) black.push_back(MakeView(std::to_string(i), i));
  EXPECT_THAT(WhyMissing(MakeReport(black, {})),
              AllOf(StartsWith("0 (0 features: blurred, dark or without texture), 1 (1 features"),
                    HasSubstr("4 (4 features"), Not(HasSubstr("5 (5")), HasSubstr("and 2 more")));
}

TEST(ReportToJson, HasTheDocumentedKeys) {
  const nlohmann::json json = ReportToJson(ReportWith({MakeView("c", 3000, {{"b", 22, false}})}));
  EXPECT_EQ(json.at("photos"), 3);
  EXPECT_EQ(json.at("registered"), 2);
  EXPECT_EQ(json.at("points"), 200);
  EXPECT_EQ(json.at("warnings").size(), 1u);
  const nlohmann::json& a = json.at("views").at(0);
  EXPECT_EQ(a.at("registered"), true);
  EXPECT_TRUE(a.at("why").is_null());
  EXPECT_TRUE(a.at("advice").is_null());
  EXPECT_EQ(a.at("parallax_degrees"), 6.5);
  EXPECT_EQ(a.at("neighbors").at(0), (nlohmann::json{{"name", "b"}, {"inliers", 300}, {"pure_rotation", false}}));
  const nlohmann::json& c = json.at("views").at(2);
  EXPECT_EQ(c.at("status"), "few_matches");
  EXPECT_TRUE(c.at("parallax_degrees").is_null());
  EXPECT_EQ(c.at("why"), "only 22 matches with b, fewer with others");
  EXPECT_EQ(json.at("attempts").at(0).at("kept"), true);
}

}  // namespace
}  // namespace oraclegs
