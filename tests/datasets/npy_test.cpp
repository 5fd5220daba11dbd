#include "oraclegs/datasets/npy.h"

#include "datasets/dataset_files.h"
#include "support/errors.h"

namespace oraclegs {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;

const std::vector<double> kSix = {0, 1, 2, 3, 4, 5};

std::string NpyError(const std::string& bytes) {
  return MessageOf<InputError>([&] { ParseNpy(bytes, "a.npy"); });
}

TEST(ParseNpy, ReadsDoublesAndFloats) {
  const NpyArray doubles = ParseNpy(NpyOf("(2, 3)", kSix), "a.npy");
  EXPECT_THAT(doubles.shape, ElementsAre(2, 3));
  EXPECT_EQ(doubles.values, kSix);
  EXPECT_EQ(doubles.ShapeWords(), "2 x 3");
  const float numbers[] = {1.5f, -2};
  const std::string_view data(reinterpret_cast<const char*>(numbers), sizeof numbers);
  EXPECT_THAT(ParseNpy(NpyOf("(2,)", data, "<f4"), "a.npy").values, ElementsAre(1.5, -2));
}

TEST(ParseNpy, TurnsFortranOrder) {
  const std::string_view data(reinterpret_cast<const char*>(kSix.data()), 48);
  EXPECT_THAT(ParseNpy(NpyOf("(2, 3)", data, "<f8", "True"), "a.npy").values, ElementsAre(0, 2, 4, 1, 3, 5));
}

TEST(ParseNpy, ReadsVersion2AndASingleNumber) {
  std::string two = NpyOf("(2, 3)", kSix);
  two[6] = 2;
  two.insert(10, 2, '\0');
  EXPECT_EQ(ParseNpy(two, "a.npy").values, kSix);
  EXPECT_EQ(ParseNpy(NpyOf("()", kSix), "a.npy").ShapeWords(), "a single number");
}

TEST(ParseNpy, RefusesOtherNumbers) {
  for (const char* type : {">f8", "<i8", "|O", "<c16"}) {
    EXPECT_THAT(NpyError(NpyOf("(2,)", std::string(64, '\0'), type)), HasSubstr(".astype('<f8')")) << type;
  }
}

TEST(ParseNpy, RefusesLengthsThatDoNotFit) {
  const std::string whole = NpyOf("(2, 3)", kSix);
  EXPECT_THAT(NpyError(NpyOf("(0, 17)", "")), HasSubstr("its shape '(0, 17)'"));
  EXPECT_THAT(NpyError(NpyOf("()", "1234567")), HasSubstr("its shape '()'"));
  EXPECT_THAT(NpyError("PK"), HasSubstr("a.npy: is not a .npy file"));
  EXPECT_THAT(NpyError(whole.substr(0, 20)), HasSubstr("cut short within its header"));
  EXPECT_THAT(NpyError(whole.substr(0, whole.size() - 1)), HasSubstr("fewer than its shape"));
  for (const char* shape : {"(3000000000, 3000000000)", "(99999999999999999999,)", "(2, 3", "[2]", "(2, -3)", "(2.5,)",
                            "(1,1,1,1,1,1,1,1,1,1)"}) {
    EXPECT_THAT(NpyError(NpyOf(shape, kSix)), HasSubstr("shape")) << shape;
  }
}

}  // namespace
}  // namespace oraclegs
