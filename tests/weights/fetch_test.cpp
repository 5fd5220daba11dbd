#include "oraclegs/weights/fetch.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "environment.h"
#include "oraclegs/core/error.h"
#include "oraclegs/core/files.h"
#include "oraclegs/core/safetensors.h"
#include "oraclegs/weights/folder.h"
#include "scripted_server.h"
#include "support/event_recorder.h"
#include "support/temp_dir.h"

namespace oraclegs {
namespace {

using testing::AllOf;
using testing::Contains;
using testing::HasSubstr;
using testing::Not;
using testing::StrEq;
using testing::ThrowsMessage;

TEST(LicenceText, IsOneLine) {
  EXPECT_EQ(LicenceText(WeightsNamed("seva")),
            "seva: licence Stability AI Non-Commercial License; not for commercial use; it covers the images that the "
            "network makes, too; see https://huggingface.co/stabilityai/stable-virtual-camera");
  EXPECT_EQ(LicenceText(WeightsNamed("sd21-vae")),
            "sd21-vae: licence MIT; see https://huggingface.co/stabilityai/sd-vae-ft-mse");
}

TEST(AtMirror, ReplacesTheHost) {
  EXPECT_EQ(AtMirror("https://h.co/a/b?c", ""), "https://h.co/a/b?c");
  EXPECT_EQ(AtMirror("https://h.co/a/b", "http://m:80"), "http://m:80/a/b");
  EXPECT_EQ(AtMirror("https://h.co/a/b", "http://m/x/"), "http://m/x/a/b");
}

TEST(FetchSettingsFromEnvironment, ReadsVariables) {
  const ScopedVariable mirror("ORACLEGS_MODELS_URL", "http://m"), token("HF_TOKEN", "hf_1");
  EXPECT_EQ(FetchSettingsFromEnvironment("c.py").token, "hf_1");
  EXPECT_EQ(FetchSettingsFromEnvironment("c.py").mirror, "http://m");
  const ScopedVariable bad("HF_TOKEN", "a\r\nEvil: 1");
  EXPECT_THAT([] { FetchSettingsFromEnvironment("c.py"); },
              ThrowsMessage<UsageError>(StrEq("HF_TOKEN holds blanks or line breaks; set it to the token alone")));
  const ScopedVariable none("HF_TOKEN", std::nullopt), wrong("ORACLEGS_MODELS_URL", "ftp://m");
  EXPECT_THAT(
      [] { FetchSettingsFromEnvironment("c.py"); },
      ThrowsMessage<UsageError>(StrEq("ORACLEGS_MODELS_URL is 'ftp://m', must begin with http:// or https://")));
}

class FetchWeightsTest : public testing::Test {
 protected:
  std::filesystem::path Fetch(const std::string& name, const FetchSettings& settings, bool accept = true) {
    FetchOptions options;
    options.accept_licence = accept;
    return FetchWeights(WeightsNamed(name), options, settings, events_.AsListener());
  }
  TempDir dir_;
  EventRecorder events_;

 private:
  ScopedVariable folder_{"ORACLEGS_MODELS", dir_.path().string()};
  ScopedVariable no_proxy_{"no_proxy", "127.0.0.1"};
};

TEST_F(FetchWeightsTest, RequiresTheLicence) {
  EXPECT_THAT([&] { Fetch("seva", {}, false); },
              ThrowsMessage<UsageError>(AllOf(HasSubstr("seva: licence Stability AI Non-Commercial License"),
                                              HasSubstr("if you agree to it, add --accept-licence"))));
  EXPECT_TRUE(std::filesystem::is_empty(dir_.path()));
}

TEST_F(FetchWeightsTest, KeepsWhatIsHere) {
  WriteFileAtomically(dir_ / "seva.safetensors", "x");
  EXPECT_EQ(Fetch("seva", {"", "http://127.0.0.1:1", ""}, false), dir_ / "seva.safetensors");
  // What `models check` advises must not end in a circle.
  EXPECT_THAT(events_.warnings, testing::ElementsAre(AllOf(HasSubstr("seva.safetensors: has 1 bytes"),
                                                           HasSubstr("is not replaced: remove it first"))));
}

TEST_F(FetchWeightsTest, KeepsASafetensorsFile) {
  const std::string bytes = SerializeSafetensors({}, {{"a", "b"}});
  ScriptedServer server({File(bytes)});
  EXPECT_EQ(Fetch("seva", {"hf_1", server.Url(""), ""}), dir_ / "seva/model.safetensors");
  EXPECT_EQ(ReadFile(RequireWeights("seva")), bytes);
  EXPECT_THAT(events_.notes, Contains(LicenceText(WeightsNamed("seva"))));
  // The file is what the server has, but not what the program can use.
  EXPECT_THAT(events_.warnings,
              Contains(AllOf(HasSubstr("does not hold seva; 1146 missing: "), HasSubstr("and 1126 more"))));
  EXPECT_THAT(server.Requests()[0],
              AllOf(HasSubstr("GET /stabilityai/stable-virtual-camera/resolve/main/modelv1.1.safetensors "),
                    HasSubstr("Bearer hf_1")));
}

TEST_F(FetchWeightsTest, SendsTheTokenToHuggingFaceOnly) {
  ScriptedServer server({Answer("404 Not Found", {"Content-Length: 0"})});
  EXPECT_THROW(Fetch("lpips-vgg", {"hf_1", server.Url(""), ""}), InputError);
  EXPECT_THAT(server.Requests()[0], AllOf(HasSubstr("GET /models/vgg16-397923af.pth "), Not(HasSubstr("hf_1"))));
}

TEST_F(FetchWeightsTest, KeepsTheFilesWithoutTheConverter) {
  ScriptedServer server({File("pickle")});
  EXPECT_THAT(
      [&] {
        Fetch("vggt-commercial", {"", server.Url(""), dir_ / "none.py"});
      },
      ThrowsMessage<RunError>(AllOf(HasSubstr("none.py is not, which converts them; then run: python3 "
                                              "scripts/convert_weights.py --model vggt-commercial --out "),
                                    HasSubstr("vggt_1B_commercial.pt"))));
  EXPECT_TRUE(std::filesystem::exists(dir_ / "vggt-commercial/vggt_1B_commercial.pt"));
  // Next time the file is not asked for again. A converter that fails says why in its last line.
  WriteFileAtomically(dir_ / "fails.py", "print('one')\nraise SystemExit('no state dict')\n");
  EXPECT_THAT(
      [&] {
        Fetch("vggt-commercial", {"", "http://127.0.0.1:1", dir_ / "fails.py"});
      },
      ThrowsMessage<RunError>(
          StrEq("vggt-commercial: cannot convert its files: no state dict (exit code 1); remove them from " +
                (dir_ / "vggt-commercial").string() + " to get them again")));
}

TEST_F(FetchWeightsTest, ReplacesPublishedFilesByConvertedOnes) {
  ScriptedServer server({File("pickle")});
  WriteFileAtomically(dir_ / "works.py", "import sys\nopen(sys.argv[4], 'wb').write(b'\\2' + b'\\0' * 7 + b'{}')\n");
  Fetch("vggt-commercial", {"", server.Url(""), dir_ / "works.py"});
  EXPECT_EQ(ReadFile(RequireWeights("vggt-commercial")).size(), 10u);
  EXPECT_FALSE(std::filesystem::exists(dir_ / "vggt-commercial/vggt_1B_commercial.pt"));
}

}  // namespace
}  // namespace oraclegs
