#include "oraclegs/weights/fetch.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "environment.h"
#include "lpips_files.h"
#include "oraclegs/core/error.h"
#include "oraclegs/core/files.h"
#include "oraclegs/core/safetensors.h"
#include "oraclegs/weights/check.h"
#include "oraclegs/weights/folder.h"
#include "scripted_server.h"
#include "support/errors.h"
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

TEST(LicenseText, IsOneLine) {
  EXPECT_EQ(LicenseText(WeightsNamed("seva")),
            "seva: license Stability AI Non-Commercial License; not for commercial use; it covers the images that the "
            "network makes, too; see https://huggingface.co/stabilityai/stable-virtual-camera");
  EXPECT_EQ(LicenseText(WeightsNamed("sd21-vae")),
            "sd21-vae: license MIT; see https://huggingface.co/stabilityai/sd-vae-ft-mse");
}

TEST(AtMirror, ReplacesTheHost) {
  EXPECT_EQ(AtMirror("https://h.co/a/b?c", ""), "https://h.co/a/b?c");
  EXPECT_EQ(AtMirror("https://h.co/a/b", "http://m:80"), "http://m:80/a/b");
  EXPECT_EQ(AtMirror("https://h.co/a/b", "http://m/x/"), "http://m/x/a/b");
}

TEST(FetchSettingsFromEnvironment, ReadsVariables) {
  const ScopedVariable mirror("ORACLEGS_MODELS_URL", "http://m"), token("HF_TOKEN", "hf_1");
  EXPECT_EQ(FetchSettingsFromEnvironment().token, "hf_1");
  EXPECT_EQ(FetchSettingsFromEnvironment().mirror, "http://m");
  const ScopedVariable bad("HF_TOKEN", "a\r\nEvil: 1");
  EXPECT_THAT([] { FetchSettingsFromEnvironment(); },
              ThrowsMessage<UsageError>(StrEq("HF_TOKEN holds blanks or line breaks; set it to the token alone")));
  const ScopedVariable none("HF_TOKEN", std::nullopt), wrong("ORACLEGS_MODELS_URL", "ftp://m");
  EXPECT_THAT(
      [] { FetchSettingsFromEnvironment(); },
      ThrowsMessage<UsageError>(StrEq("ORACLEGS_MODELS_URL is 'ftp://m', must begin with http:// or https://")));
  for (const char* address :
       {"http://user:hunter2@m", "http://hunter2@m", "ftp://user:hunter2@m", "http://user:hunter2@m:x", "http://"}) {
    const ScopedVariable secret("ORACLEGS_MODELS_URL", address);
    EXPECT_THAT(MessageOf<UsageError>([] { FetchSettingsFromEnvironment(); }),
                AllOf(HasSubstr("ORACLEGS_MODELS_URL is "), Not(HasSubstr("hunter2"))));
  }
}

class FetchWeightsTest : public testing::Test {
 protected:
  std::filesystem::path Fetch(const std::string& name, const FetchSettings& settings, bool accept = true) {
    FetchOptions options;
    options.accept_license = accept;
    return FetchWeights(WeightsNamed(name), options, settings, events_.AsListener());
  }
  TempDir dir_;
  EventRecorder events_;

 private:
  ScopedVariable folder_{"ORACLEGS_MODELS", dir_.path().string()};
  ScopedVariable no_proxy_{"no_proxy", "127.0.0.1"};
};

TEST_F(FetchWeightsTest, RequiresTheLicense) {
  EXPECT_THAT([&] { Fetch("seva", {}, false); },
              ThrowsMessage<UsageError>(AllOf(HasSubstr("seva: license Stability AI Non-Commercial License"),
                                              HasSubstr("if you agree to it, add --accept-license"))));
  EXPECT_TRUE(std::filesystem::is_empty(dir_.path()));
}

TEST_F(FetchWeightsTest, KeepsWhatIsHere) {
  WriteFileAtomically(dir_ / "seva.safetensors", "x");
  EXPECT_EQ(Fetch("seva", {"", "http://127.0.0.1:1"}, false), dir_ / "seva.safetensors");
  // What `models check` advises must not end in a circle.
  EXPECT_THAT(events_.warnings, testing::ElementsAre(AllOf(HasSubstr("seva.safetensors: has 1 bytes"),
                                                           HasSubstr("is not replaced: remove it first"))));
}

TEST_F(FetchWeightsTest, KeepsASafetensorsFile) {
  const std::string bytes = SerializeSafetensors({}, {{"a", "b"}});
  ScriptedServer server({File(bytes)});
  EXPECT_THAT(
      [&] {
        Fetch("vggt-commercial", {"hf_1", "https://mirror.example"});
      },
      ThrowsMessage<UsageError>(AllOf(HasSubstr("checksum is not known"), HasSubstr("ORACLEGS_MODELS_URL"))));
  EXPECT_EQ(Fetch("vggt-commercial", {"hf_1", server.Url("")}), dir_ / "vggt-commercial/model.safetensors");
  EXPECT_EQ(ReadFile(RequireWeights("vggt-commercial")), bytes);
  EXPECT_THAT(events_.notes, Contains(LicenseText(WeightsNamed("vggt-commercial"))));
  // The file is what the server has, but not what the program can use.
  EXPECT_THAT(events_.warnings,
              Contains(AllOf(HasSubstr("does not hold vggt-commercial; 1341 missing: "), HasSubstr("and 1321 more"))));
  EXPECT_THAT(server.Requests()[0],
              AllOf(HasSubstr("GET /facebook/VGGT-1B-Commercial/resolve/"), HasSubstr("Bearer hf_1")));
}

TEST_F(FetchWeightsTest, SendsTheTokenToHuggingFaceOnly) {
  ScriptedServer server({Answer("404 Not Found", {"Content-Length: 0"})});
  EXPECT_THROW(Fetch("lpips-vgg", {"hf_1", server.Url("")}), InputError);
  EXPECT_THAT(server.Requests()[0], AllOf(HasSubstr("GET /models/vgg16-397923af.pth "), Not(HasSubstr("hf_1"))));
}

TEST_F(FetchWeightsTest, TellsThisMachineByTheHostAndNotByTheText) {
  const auto behind = [](const ScriptedServer& server, const std::string& user) {
    std::string url = server.Url("");
    return url.insert(url.find("://") + 3, user + "@");
  };
  ScriptedServer server({Answer("404 Not Found", {"Content-Length: 0"})});
  EXPECT_THROW(Fetch("seva", {"hf_1", behind(server, "localhost:x")}), InputError);
  EXPECT_THAT(server.Requests()[0], Not(HasSubstr("hf_1"))) << "the address may lead to any machine";
  EXPECT_THAT(MessageOf<UsageError>([&] {
                Fetch("vggt-commercial", {"", "http://127.0.0.1:x@mirror.example"});
              }),
              HasSubstr("checksum is not known"));
}

TEST_F(FetchWeightsTest, KeepsPublishedFilesThatCannotBeConverted) {
  WeightsInfo model = WeightsNamed("lpips-alex");
  model.files = {{"https://host/features.pth"}};  // no checksum
  ScriptedServer server({File("pickle")});
  const std::string file = (dir_ / "lpips-alex/features.pth").string();
  const std::string expected = "lpips-alex: cannot convert its files: " + file +
                               ": is neither a checkpoint of PyTorch nor a safetensors file; name the published file; "
                               "remove them from " +
                               (dir_ / "lpips-alex").string() + " to get them again";
  FetchOptions options;
  options.accept_license = true;
  // The second time the file is not asked for again.
  for (const std::string& url : {server.Url(""), std::string("http://127.0.0.1:1")}) {
    EXPECT_EQ(MessageOf<RunError>([&] { FetchWeights(model, options, {"", url}, events_.AsListener()); }), expected);
    EXPECT_EQ(ReadFile(file), "pickle");
  }
}

TEST_F(FetchWeightsTest, ReplacesPublishedFilesByConvertedOnes) {
  for (const bool keep : {false, true}) {
    WeightsInfo model = WeightsNamed("lpips-alex");
    model.files = {{"https://host/features.pth"}, {"https://host/taps.pth"}};  // no checksums
    ScriptedServer server({File(LpipsFeatures()), File(LpipsTaps())});
    FetchOptions options;
    options.accept_license = true;
    options.keep_published = keep;
    const auto weights = FetchWeights(model, options, {"", server.Url("")}, events_.AsListener());
    EXPECT_EQ(CheckWeights(model, weights, Silent()), 15u);
    EXPECT_EQ(std::filesystem::exists(dir_ / "lpips-alex/features.pth"), keep);
    EXPECT_EQ(std::filesystem::exists(dir_ / "lpips-alex/taps.pth"), keep);
    std::filesystem::remove_all(dir_ / "lpips-alex");
  }
}

}  // namespace
}  // namespace oraclegs
