#include "oraclegs/formats/usd_transform.h"

#include <Eigen/Geometry>
#include <numbers>

#include "support/errors.h"

namespace oraclegs {
namespace {

using testing::HasSubstr;

/// The transform of a prim with these attributes, a line each.
UsdTransform TransformOf(const std::string& lines) {
  const std::string text = "#usda 1.0\n" + lines;
  UsdaText usda(text, "f");
  UsdTransform transform;
  while (!usda.AtEnd()) {
    const std::string_view type = usda.Word(), name = usda.Word();
    usda.Take('=');
    EXPECT_TRUE(UsdTransform::IsPart(name));
    transform.Read(type, name, &usda);
  }
  return transform;
}

Eigen::Vector3d Moved(const std::string& lines, const Eigen::Vector3d& point) {
  return (TransformOf(lines).Matrix("f") * point.homogeneous()).head<3>();
}

void ExpectNear(const Eigen::Vector3d& a, const Eigen::Vector3d& b) { EXPECT_LT((a - b).norm(), 1e-12) << a << b; }

TEST(UsdTransform, DoesTheLastOperationFirst) {
  const std::string ops =
      "double3 xformOp:translate = (1, 2, 3)\nfloat xformOp:rotateZ = 90\nfloat3 xformOp:scale = (2, 2, 2)\n";
  ExpectNear(
      Moved(ops + "token[] xformOpOrder = [\"xformOp:translate\", \"xformOp:rotateZ\", \"xformOp:scale\"]", {1, 0, 0}),
      {1, 4, 3});
  ExpectNear(Moved(ops + "token[] xformOpOrder = [\"xformOp:scale\", \"xformOp:translate\"]", {1, 0, 0}), {4, 4, 6});
  ExpectNear(Moved(ops, {1, 0, 0}), {1, 0, 0});
}

TEST(UsdTransform, HasRowsAsUsdHas) {
  ExpectNear(Moved("matrix4d xformOp:transform = ( (0, 1, 0, 0), (-1, 0, 0, 0), (0, 0, 1, 0), (5, 6, 7, 1) )\n"
                   "token[] xformOpOrder = [\"xformOp:transform\"]",
                   {1, 0, 0}),
             {5, 7, 7});
}

TEST(UsdTransform, TurnsInTheOrderOfTheName) {
  const auto turn = [](const std::string& kind) {
    return Moved("float3 xformOp:" + kind + ":a = (90, 0, 90)\ntoken[] xformOpOrder = [\"xformOp:" + kind + ":a\"]",
                 {0, 1, 0});
  };
  ExpectNear(turn("rotateXYZ"), {0, 0, 1});   // about x to z, about z stays
  ExpectNear(turn("rotateZYX"), {-1, 0, 0});  // about z to -x, about x stays
  const double half = std::sqrt(0.5);
  ExpectNear(Moved(fmt::format("quatf xformOp:orient = ({}, 0, 0, {})\ntoken[] xformOpOrder = [\"xformOp:orient\"]",
                               half, half),
                   {1, 0, 0}),
             {0, 1, 0});
}

TEST(UsdTransform, InvertsAndResets) {
  const std::string pivot = "float3 xformOp:translate:pivot = (1, 0, 0)\nfloat xformOp:rotateY = 180\n";
  const std::string order =
      "token[] xformOpOrder = [\"!resetXformStack!\", \"xformOp:translate:pivot\", \"xformOp:rotateY\", "
      "\"!invert!xformOp:translate:pivot\"]";
  ExpectNear(Moved(pivot + order, {0, 1, 0}), {2, 1, 0});
  EXPECT_TRUE(TransformOf(pivot + order).ResetsStack());
  EXPECT_FALSE(TransformOf(pivot).ResetsStack());
}

TEST(UsdTransform, RefusesWhatItDoesNotKnow) {
  const auto error = [](const std::string& lines) {
    return MessageOf<InputError>([&] { TransformOf(lines).Matrix("f"); });
  };
  for (const char* kind : {"shear", "rotateXY", "rotateW", "rotate"}) {
    const std::string name = std::string("xformOp:") + kind;
    EXPECT_THAT(error("float3 " + name + " = (1, 2, 3)\ntoken[] xformOpOrder = [\"" + name + "\"]"),
                HasSubstr("f: xformOpOrder names \"" + name + "\", which has no value or is not known"));
  }
  EXPECT_THAT(error("double3 xformOp:translate = [(1, 2, 3), (4, 5, 6)]"), HasSubstr("has 6 numbers, expected 3"));
}

}  // namespace
}  // namespace oraclegs
