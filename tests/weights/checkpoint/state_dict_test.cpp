#include "oraclegs/weights/checkpoint/state_dict.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "oraclegs/core/error.h"
#include "oraclegs/weights/checkpoint/torch_file.h"
#include "support/errors.h"
#include "torch_bytes.h"

namespace oraclegs {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;
using namespace torch_bytes;  // NOLINT: pieces of pickles

/// The names of the tensors in a checkpoint, whose storages 0 and 1 hold three floats each.
std::vector<std::string> NamesIn(const std::string& root, const std::string& key = "") {
  const std::string file = ZipFile(root, {{"0", Floats({1, 2, 3})}, {"1", Floats({4, 5, 6})}});
  PickleHeap heap;
  heap.file = "f.pt";
  const PickleValue value = ReadTorchFile(file, &heap);
  std::vector<std::string> names;
  for (const auto& [name, tensor] : FindStateDict(value, key, heap)) names.push_back(name);
  return names;
}
std::string ErrorOfFinding(const std::string& root, const std::string& key = "") {
  return MessageOf<InputError>([&] { NamesIn(root, key); });
}
std::string Object(const std::string& type, const std::string& state) {
  return Call(Global("mine", type), {}) + state + 'b';
}
std::string Module(const std::string& parameters, const std::string& buffers, const std::string& modules) {
  return Object(
      "Net", Dict({{"training", "\x88"}, {"_parameters", parameters}, {"_buffers", buffers}, {"_modules", modules}}));
}

const std::string kA = Vector("0", 3), kB = Vector("1", 3);

TEST(FindStateDict, LooksBelowUsualKeys) {
  const std::string state = Dict({{"a", kA}, {"b", kB}, {"version", Int(3)}});
  for (const std::string& root :
       {state, Dict({{"epoch", Int(1)}, {"state_dict", state}}), Dict({{"model", Dict({{"state_dict", state}})}}),
        Dict({{"ema", state}, {"model", "N"}}), Dict({{"params", Dict({{"rate", Int(1)}})}, {"module", state}})}) {
    EXPECT_THAT(NamesIn(root), ElementsAre("a", "b"));
  }
  EXPECT_THAT(NamesIn(Dict({{"state_dict", Dict({{"a", kA}})}, {"ema", Dict({{"b", kB}})}})), ElementsAre("a"));
}

TEST(FindStateDict, TakesTheWantedKey) {
  const std::string root = Dict({{"encoder", Dict({{"a", kA}})}, {"decoder", Dict({{"b", kB}})}});
  EXPECT_THAT(NamesIn(root, "decoder"), ElementsAre("b"));
  EXPECT_EQ(ErrorOfFinding(root), "f.pt: holds no state dict, but: decoder, encoder; choose one with --key");
  EXPECT_EQ(ErrorOfFinding(root, "x"), "f.pt: holds nothing under --key x, but: decoder, encoder");
}

TEST(FindStateDict, NamesTheTensorsOfNetworks) {
  const std::string norm = Module("}", Dict({{"mean", kB}}), "}");
  const std::string net = Module(Dict({{"scale", kA}, {"bias", "N"}}), "}", Dict({{"norm", norm}, {"none", "N"}}));
  for (const std::string& root : {net, Dict({{"model", net}})}) {
    EXPECT_THAT(NamesIn(root), ElementsAre("norm.mean", "scale"));
  }
  // TorchScript.
  EXPECT_THAT(NamesIn(Object("Net", Dict({{"weight", kA}, {"0", Object("Layer", Dict({{"bias", kB}}))}}))),
              ElementsAre("0.bias", "weight"));
}

TEST(FindStateDict, RefusesOtherThings) {
  EXPECT_EQ(ErrorOfFinding(List({kA})), "f.pt: holds no state dict, but: a list; choose one with --key");
  EXPECT_EQ(ErrorOfFinding("}"), "f.pt: holds no state dict, but: a dict without names; choose one with --key");
  EXPECT_EQ(ErrorOfFinding(Object("Net", "}")),
            "f.pt: holds no state dict, but: an object of mine Net; choose one with --key");
  std::vector<std::pair<std::string, std::string>> many;
  for (char c = 'a'; c < 'z'; ++c) many.emplace_back(std::string(1, c), "N");
  EXPECT_THAT(ErrorOfFinding(Dict(many)), HasSubstr("but: a, b, c, d, e, f, g, h, i, j; choose"));
}

TEST(FindStateDict, ChecksTensorsAndNames) {
  EXPECT_EQ(ErrorOfFinding(Dict({{"x", Tensor(Storage("0", 3), {{4}, {1}})}})),
            "f.pt: tensor 'x' reaches beyond its numbers; get the file again");
  EXPECT_THAT(ErrorOfFinding(Dict({{std::string(1001, 'x'), kA}})), HasSubstr("a name of 1001 bytes"));
}

TEST(FindStateDict, StopsInCircles) {
  const std::string save("q\0", 2), same("h\0", 2);
  EXPECT_THAT(ErrorOfFinding('}' + save + Text("model") + same + 's'), HasSubstr("holds no state dict"));
  const std::string circle = Call(Global("mine", "Net"), {}) + save + Dict({{"self", same}, {"w", kA}}) + 'b';
  EXPECT_EQ(ErrorOfFinding(circle), "f.pt: its modules are too many or contain each other; save its state dict alone");
  // Each of 40 modules holds the next one twice.
  std::string modules = Object("Net", Dict({{"w", kA}}));
  for (char i = 0; i < 40; ++i) {
    const std::string key(1, static_cast<char>(i + 1));
    modules += 'q' + key + '0' + Object("Net", Dict({{"a", 'h' + key}, {"b", 'h' + key}}));
  }
  EXPECT_THAT(ErrorOfFinding(modules), HasSubstr("too many or contain each other"));
}

TEST(WithoutWrapperNames, DropsWhatAllNamesBeginWith) {
  const auto names = [](const std::vector<std::string>& all) {
    StateDict state;
    for (const std::string& name : all) state[name] = {};
    std::vector<std::string> left;
    for (const auto& [name, tensor] : WithoutWrapperNames(std::move(state))) left.push_back(name);
    return left;
  };
  EXPECT_THAT(names({"module.a", "module.b.c"}), ElementsAre("a", "b.c"));
  EXPECT_THAT(names({"module._orig_mod.model.a"}), ElementsAre("a"));
  EXPECT_THAT(names({"module.a", "b"}), ElementsAre("b", "module.a"));
  EXPECT_THAT(names({}), ElementsAre());
}

}  // namespace
}  // namespace oraclegs
