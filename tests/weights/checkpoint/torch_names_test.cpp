#include "oraclegs/weights/checkpoint/torch_names.h"

#include <gtest/gtest.h>

namespace oraclegs {
namespace {

TEST(KnownGlobal, KnowsTypes) {
  for (const std::string name :
       {"torch FloatStorage", "torch.cuda FloatStorage", "torch FloatTensor", "torch float32"}) {
    const PickleGlobal global = KnownGlobal(name);
    EXPECT_EQ(global.name, name);
    EXPECT_STREQ(global.element.name, "F32") << name;
    EXPECT_EQ(global.element.bytes, 4) << name;
  }
  EXPECT_EQ(KnownGlobal("torch FloatTensor").role, PickleRole::kTensorType);
  EXPECT_EQ(KnownGlobal("torch bfloat16").role, PickleRole::kElementType);
  EXPECT_EQ(KnownGlobal("torch.storage UntypedStorage").role, PickleRole::kStorageType);
  EXPECT_EQ(KnownGlobal("torch.storage UntypedStorage").element.bytes, 1);
}

TEST(KnownGlobal, KnowsFunctions) {
  EXPECT_EQ(KnownGlobal("torch._utils _rebuild_tensor_v2").role, PickleRole::kRebuildTensor);
  EXPECT_EQ(KnownGlobal("torch._utils _rebuild_parameter").role, PickleRole::kFirstArgument);
  EXPECT_EQ(KnownGlobal("collections OrderedDict").role, PickleRole::kDict);
  for (const std::string name : {"torch storage", "mine FloatStorage", "numpy.core.multiarray scalar", ""}) {
    EXPECT_EQ(KnownGlobal(name).role, PickleRole::kOther) << name;
    EXPECT_EQ(KnownGlobal(name).name, name);
  }
}

TEST(RunsPrograms, KnowsTheUsualAttacks) {
  EXPECT_TRUE(RunsPrograms("os", "system"));
  EXPECT_TRUE(RunsPrograms("posix", "system"));
  EXPECT_TRUE(RunsPrograms("subprocess", "Popen"));
  EXPECT_TRUE(RunsPrograms("__builtin__", "eval"));
  EXPECT_TRUE(RunsPrograms("_io", "open"));
}

TEST(RunsPrograms, LeavesWhatCheckpointsHold) {
  EXPECT_FALSE(RunsPrograms("builtins", "getattr"));  // enumerations
  EXPECT_FALSE(RunsPrograms("builtins", "set"));
  EXPECT_FALSE(RunsPrograms("code.models", "Net"));  // a package of the user's
  EXPECT_FALSE(RunsPrograms("argparse", "Namespace"));
  EXPECT_FALSE(RunsPrograms("numpy", "dtype"));
}

}  // namespace
}  // namespace oraclegs
