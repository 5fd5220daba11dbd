#include "oraclegs/sfm/registration_report.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <Eigen/LU>
#include <cmath>

namespace oraclegs {
namespace {

using testing::AllOf;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;
using testing::Not;
using testing::StartsWith;

PhotoReport LoadedView(const std::string& name, int features, std::vector<Neighbour> neighbours = {}) {
  PhotoReport photo;
  photo.name = name;
  photo.features = features;
  photo.neighbours = std::move(neighbours);
  return photo;
}

/// a and b are registered; the rest of `others` is not.
RegistrationReport ReportWith(std::vector<PhotoReport> others) {
  std::vector<PhotoReport> photos{LoadedView("a", 4000, {{"b", 300, false}}), LoadedView("b", 5000, {{"a", 300, false}})};
  for (PhotoReport& photo : others) photos.push_back(std::move(photo));
  AttemptResult result;
  result.best.images = {{"a", {200, 6.5}}, {"b", {200, 6.5}}};
  result.best.points = 200;
  result.best.parallax_degrees = 6.5;
  result.attempts = {{"usual features", "strict", 2, 200, .4, 6.5, true}};
  return MakeReport(std::move(photos), result);
}

Eigen::Matrix3d Intrinsics(double focal) {
  Eigen::Matrix3d k;
  k << focal, 0, 500, 0, focal, 400, 0, 0, 1;
  return k;
}

TEST(TurnResidual, ATurnIsKnownWithoutTheFocalLength) {
  const Eigen::Matrix3d turn =
      (Eigen::AngleAxisd(.3, Eigen::Vector3d::UnitY()) * Eigen::AngleAxisd(.1, Eigen::Vector3d::UnitX()))
          .toRotationMatrix();
  for (const double focal : {600., 850., 1200., 2000.}) {
    const Eigen::Matrix3d map = Intrinsics(focal) * turn * Intrinsics(focal).inverse();
    EXPECT_LT(TurnResidual(map, {1000, 800}, {1000, 800}), .012) << focal;
    EXPECT_NEAR(TurnResidual(-3 * map, {1000, 800}, {1000, 800}), TurnResidual(map, {1000, 800}, {1000, 800}), 1e-9)
        << "a homography has no scale";
  }
}

TEST(TurnResidual, AStepAsideBeforeAWallIsNoTurn) {
  const Eigen::Vector3d normal = Eigen::Vector3d(.1, 0, 1).normalized();
  for (const Eigen::Vector3d& step : {Eigen::Vector3d(.2, 0, 0), Eigen::Vector3d(0, 0, .2)}) {
    const Eigen::Matrix3d map =
        Intrinsics(900) * (Eigen::Matrix3d::Identity() + step * normal.transpose()) * Intrinsics(900).inverse();
    EXPECT_GT(TurnResidual(map, {1000, 800}, {1000, 800}), .03);
  }
  EXPECT_TRUE(std::isinf(TurnResidual(Eigen::Matrix3d::Zero(), {10, 8}, {10, 8})));
}

TEST(MakeReport, ARegisteredPhotographHasItsParallaxAndNoAdvice) {
  const RegistrationReport report = ReportWith({});
  EXPECT_EQ(report.registered(), 2);
  EXPECT_EQ(report.photos[0].verdict, PhotoVerdict::kRegistered);
  EXPECT_EQ(report.photos[0].parallax_degrees, 6.5);
  EXPECT_EQ(report.photos[0].points, 200);
  EXPECT_EQ(report.photos[0].advice, "");
  EXPECT_THAT(report.warnings, IsEmpty());
}

TEST(MakeReport, SaysWhyAPhotographIsMissingAndWhatToTake) {
  PhotoReport copy = LoadedView("z-copy", 0);
  copy.same_as = "a";
  const RegistrationReport report = ReportWith({LoadedView("c-black", 12), LoadedView("d-alone", 3000),
                                                LoadedView("e-far", 3000, {{"a", 16, false}, {"b", 22, false}}),
                                                LoadedView("f-turned", 3000, {{"b", 400, true}, {"a", 20, false}}),
                                                LoadedView("g-odd", 3000, {{"a", 90, true}, {"b", 60, false}}), copy});
  const auto& p = report.photos;
  EXPECT_EQ(p[2].verdict, PhotoVerdict::kFewFeatures);
  EXPECT_THAT(p[2].advice, HasSubstr("only 12 features: blurred"));
  EXPECT_EQ(p[3].verdict, PhotoVerdict::kNoMatches);
  EXPECT_EQ(p[3].advice, "take one between b and d-alone, and one between it and a");
  EXPECT_EQ(p[4].verdict, PhotoVerdict::kFewMatches);
  EXPECT_EQ(p[4].neighbours[0].name, "b") << "the best is first";
  EXPECT_EQ(p[4].advice, "take one between b and e-far");
  EXPECT_EQ(p[5].verdict, PhotoVerdict::kTurnedOnTheSpot);
  EXPECT_EQ(p[5].advice, "move sideways, do not turn on the spot");
  EXPECT_EQ(p[6].verdict, PhotoVerdict::kDoesNotFit);
  EXPECT_EQ(p[7].verdict, PhotoVerdict::kSamePhotograph);
  EXPECT_THAT(report.warnings,
              ElementsAre("z-copy is the same photograph as a and is left out",
                          AllOf(StartsWith("registered 2 of 8 photographs; not registered: c-black (12 features"),
                                HasSubstr("d-alone (no matches with any other)"),
                                HasSubstr("e-far (only 22 matches with b, fewer with others)"), HasSubstr("1 more"),
                                HasSubstr("take it again sharp"))));
  for (const std::string& warning : report.warnings) EXPECT_THAT(warning, Not(HasSubstr("\n")));
}

TEST(MakeReport, WeakParallaxIsToldOfThePhotographAndOfAll) {
  AttemptResult result;
  result.best.images = {{"a", {200, .4}}, {"b", {200, .4}}};
  result.best.parallax_degrees = .4;
  const RegistrationReport report = MakeReport({LoadedView("a", 4000), LoadedView("b", 4000)}, result);
  EXPECT_THAT(report.photos[0].advice, HasSubstr("to the side"));
  EXPECT_THAT(report.warnings, ElementsAre(AllOf(HasSubstr("nearly one point"), HasSubstr("0.40 degrees"))));
}

TEST(TakenFromOnePoint, EveryPairThatMatchesIsATurn) {
  const AttemptResult none;
  const auto report = [&](bool turned) {
    return MakeReport({LoadedView("a", 4000, {{"b", 300, true}}), LoadedView("b", 4000, {{"a", 300, true}, {"c", 99, turned}}),
                       LoadedView("c", 4000, {{"b", 99, turned}, {"a", 12, false}})},
                      none);
  };
  EXPECT_TRUE(TakenFromOnePoint(report(true))) << "twelve matches are chance";
  EXPECT_FALSE(TakenFromOnePoint(report(false)));
  EXPECT_FALSE(TakenFromOnePoint(MakeReport({LoadedView("a", 9), LoadedView("b", 9)}, none))) << "nothing is known";
}

TEST(WhyMissing, NamesFiveAndCountsTheRest) {
  std::vector<PhotoReport> black;
  for (int i = 0; i < 7; ++i) black.push_back(LoadedView(std::to_string(i), i));
  EXPECT_THAT(WhyMissing(MakeReport(black, {})),
              AllOf(StartsWith("0 (0 features: blurred, dark or without texture), 1 (1 features"),
                    HasSubstr("4 (4 features"), Not(HasSubstr("5 (5")), HasSubstr("and 2 more")));
}

TEST(ReportToJson, HasTheDocumentedKeys) {
  const nlohmann::json json = ReportToJson(ReportWith({LoadedView("c", 3000, {{"b", 22, false}})}));
  EXPECT_EQ(json.at("photographs"), 3);
  EXPECT_EQ(json.at("registered"), 2);
  EXPECT_EQ(json.at("points"), 200);
  EXPECT_EQ(json.at("warnings").size(), 1u);
  const nlohmann::json& a = json.at("views").at(0);
  EXPECT_EQ(a.at("registered"), true);
  EXPECT_TRUE(a.at("why").is_null());
  EXPECT_TRUE(a.at("advice").is_null());
  EXPECT_EQ(a.at("parallax_degrees"), 6.5);
  EXPECT_EQ(a.at("neighbours").at(0), (nlohmann::json{{"name", "b"}, {"inliers", 300}, {"turned_only", false}}));
  const nlohmann::json& c = json.at("views").at(2);
  EXPECT_EQ(c.at("verdict"), "few_matches");
  EXPECT_TRUE(c.at("parallax_degrees").is_null());
  EXPECT_EQ(c.at("why"), "only 22 matches with b, fewer with others");
  EXPECT_EQ(json.at("attempts").at(0).at("kept"), true);
}

}  // namespace
}  // namespace oraclegs
