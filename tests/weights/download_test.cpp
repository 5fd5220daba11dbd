#include "oraclegs/weights/download.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "environment.h"
#include "oraclegs/core/error.h"
#include "oraclegs/core/files.h"
#include "oraclegs/core/sha256.h"
#include "scripted_server.h"
#include "support/event_recorder.h"
#include "support/temp_dir.h"

namespace oraclegs {
namespace {

using testing::AllOf;
using testing::ElementsAre;
using testing::EndsWith;
using testing::HasSubstr;
using testing::IsEmpty;
using testing::Not;
using testing::SizeIs;

const std::string kBody = "0123456789";
const std::string kSha256 = "84d89877f0d4041efb6bf91a16f0248f2fd573e6af05c19f96bedb9f882f7882";

std::string Tag(const std::string& sha256) { return "X-Linked-Etag: \"" + sha256 + "\""; }

/// The first `size` bytes of a longer file, and an end.
std::string Cut(size_t size, std::vector<std::string> headers = {}) {
  headers.push_back("Content-Length: 10");
  return Answer("200 OK", headers, kBody.substr(0, size));
}

std::string Rest(size_t from, size_t to = 10, const std::string& range = "") {
  return Answer("206 Partial Content",
                {range.empty() ? fmt::format("Content-Range: bytes {}-9/10", from) : "Content-Range: " + range,
                 fmt::format("Content-Length: {}", 10 - from)},
                kBody.substr(from, to - from));
}

class DownloadTest : public testing::Test {
 protected:
  DownloadRequest Request(const ScriptedServer& server) const {
    DownloadRequest request;
    request.url = server.Url();
    request.to = dir_ / "model/f";
    request.stage = "fetch f";
    return request;
  }
  void Run(const DownloadRequest& request) { Download(request, events_.AsListener()); }
  /// The one-line error that the download ends with.
  template <class Kind = RunError>
  std::string ErrorOf(const DownloadRequest& request) {
    try {
      Run(request);
    } catch (const Kind& error) {
      EXPECT_THAT(error.what(), Not(HasSubstr("\n")));
      EXPECT_FALSE(std::filesystem::exists(request.to));
      return error.what();
    }
    ADD_FAILURE() << "did not fail";
    return "";
  }
  std::string Got() const { return ReadFile(dir_ / "model/f"); }
  bool HasPart() const { return std::filesystem::exists(dir_ / "model/f.part"); }
  void Leave(const std::string& part) const { WriteFileAtomically(dir_ / "model/f.part", part); }

  TempDir dir_;
  EventRecorder events_;

 private:
  ScopedVariable no_proxy_{"no_proxy", "127.0.0.1"};
};

TEST_F(DownloadTest, ChecksTheChecksum) {
  ScriptedServer server({File(kBody)});
  DownloadRequest request = Request(server);
  request.sha256 = kSha256;
  request.bytes = 10;
  Run(request);
  EXPECT_EQ(Got(), kBody);
  EXPECT_FALSE(HasPart());
  EXPECT_THAT(events_.warnings, IsEmpty());
  EXPECT_THAT(events_.steps, SizeIs(1));
  EXPECT_EQ(events_.steps[0].stage, "fetch f");
  EXPECT_EQ(events_.steps[0].total, 1);
  EXPECT_EQ(events_.steps[0].unit, "kB");
}

TEST_F(DownloadTest, TakesTheServersChecksum) {
  ScriptedServer good({File(kBody, {Tag(kSha256)})});
  Run(Request(good));
  EXPECT_THAT(events_.warnings, IsEmpty());
  std::filesystem::remove(dir_ / "model/f");
  ScriptedServer bad({File(kBody, {"ETag: W/\"" + std::string(64, 'a') + "\""})});
  EXPECT_THAT(ErrorOf(Request(bad)), EndsWith("its SHA-256 is " + kSha256 + ", expected " + std::string(64, 'a') +
                                              "; it was damaged on the way, the same command tries again"));
  EXPECT_FALSE(HasPart());
}

TEST_F(DownloadTest, SendsTheBearer) {
  ScriptedServer server({File(kBody)});
  DownloadRequest request = Request(server);
  request.bearer = "secret";
  Run(request);
  EXPECT_THAT(server.Requests()[0], HasSubstr("Authorization: Bearer secret"));
}

TEST_F(DownloadTest, WarnsWithoutAChecksum) {
  ScriptedServer server({File(kBody, {"ETag: \"5d41-1\""})});
  Run(Request(server));
  EXPECT_THAT(events_.warnings,
              ElementsAre(EndsWith("/file: its checksum is not known, only its length was compared")));
}

TEST_F(DownloadTest, RefusesAWrongChecksum) {
  ScriptedServer server({File("9876543210")});
  DownloadRequest request = Request(server);
  request.sha256 = kSha256;
  EXPECT_THAT(ErrorOf(request), HasSubstr(", expected " + kSha256));
  EXPECT_FALSE(HasPart());
}

TEST_F(DownloadTest, RefusesAReplacedFile) {
  ScriptedServer server({File(kBody, {Tag(std::string(64, 'b'))})});
  DownloadRequest request = Request(server);
  request.sha256 = kSha256;
  EXPECT_THAT(ErrorOf(request), AllOf(HasSubstr("the server has a file with SHA-256 bbbb"), HasSubstr("was replaced")));
}

TEST_F(DownloadTest, ContinuesAnEarlierRun) {
  Leave("0123");
  ScriptedServer server({Rest(4)});
  DownloadRequest request = Request(server);
  request.sha256 = kSha256;
  Run(request);
  EXPECT_EQ(Got(), kBody);
  EXPECT_THAT(server.Requests()[0], HasSubstr("Range: bytes=4-"));
}

TEST_F(DownloadTest, RetriesWhileBytesArrive) {
  ScriptedServer server({Cut(3), Rest(3, 7), Rest(7)});
  DownloadRequest request = Request(server);
  request.sha256 = kSha256;
  Run(request);
  EXPECT_EQ(Got(), kBody);
  EXPECT_THAT(events_.notes, ElementsAre(HasSubstr("going on from byte 3"), HasSubstr("going on from byte 7")));
}

TEST_F(DownloadTest, KeepsThePartWhenNothingArrives) {
  ScriptedServer server({Cut(3), Rest(3, 3)});
  EXPECT_THAT(ErrorOf(Request(server)), EndsWith("after 3 of 10 bytes; the same command continues"));
  EXPECT_EQ(ReadFile(dir_ / "model/f.part"), "012");
}

TEST_F(DownloadTest, RestartsWithoutRanges) {
  Leave("01234567");
  ScriptedServer server({File(kBody)});
  DownloadRequest request = Request(server);
  request.sha256 = kSha256;
  Run(request);
  EXPECT_EQ(Got(), kBody);
}

TEST_F(DownloadTest, DiscardsPartsThatDoNotJoin) {
  for (const char* range : {"bytes 5-9/10", "bytes 0-9/10", "bytes x-9/10", "lines 4-9/10", "bytes 4"}) {
    Leave("0123");
    ScriptedServer server({Rest(4, 10, range), File(kBody)});
    DownloadRequest request = Request(server);
    request.sha256 = kSha256;
    Run(request);
    EXPECT_EQ(Got(), kBody) << range;
    std::filesystem::remove(request.to);
  }
  Leave("0123");
  ScriptedServer server({Rest(5), Cut(4), Rest(5)});
  EXPECT_THAT(ErrorOf(Request(server)), EndsWith("the server's parts do not join; try another server or proxy"));
}

TEST_F(DownloadTest, AcceptsACompletePart) {
  Leave(kBody);
  ScriptedServer server({Answer("416 Range Not Satisfiable", {"Content-Range: bytes */10", "Content-Length: 0"})});
  DownloadRequest request = Request(server);
  request.sha256 = kSha256;
  Run(request);
  EXPECT_EQ(Got(), kBody);
  Leave(kBody + "and more");
  std::filesystem::remove(request.to);
  ScriptedServer shorter(
      {Answer("416 Range Not Satisfiable", {"Content-Range: bytes */10", "Content-Length: 0"}), File(kBody)});
  request.url = shorter.Url();
  Run(request);
  EXPECT_EQ(Got(), kBody);
}

TEST_F(DownloadTest, DetectsTruncation) {
  ScriptedServer server(
      {Answer("200 OK", {"X-Linked-Size: 10"}, "012"), Answer("200 OK", {"X-Linked-Size: 10"}, "01")});
  EXPECT_THAT(ErrorOf(Request(server)), EndsWith("the server closed the connection after 2 of 10 bytes; the same "
                                                 "command continues"));
}

TEST_F(DownloadTest, RefusesAnotherLength) {
  ScriptedServer known({File(kBody)});
  DownloadRequest request = Request(known);
  request.bytes = 11;
  EXPECT_THAT(ErrorOf(request), HasSubstr("the server has 10 bytes, expected 11"));
  ScriptedServer endless({Answer("200 OK", {"X-Linked-Size: 4"}, kBody)});
  EXPECT_THAT(ErrorOf(Request(endless)), HasSubstr("is longer than the 4 bytes it should have"));
  EXPECT_FALSE(HasPart());
}

TEST_F(DownloadTest, ExplainsRefusals) {
  const auto refused = [&](const std::string& status) { return Answer(status, {"Content-Length: 0"}); };
  ScriptedServer server({refused("401 Unauthorized"), refused("403 Forbidden"), refused("404 Not Found"),
                         refused("503 Service Unavailable"), refused("418 I'm a teapot")});
  EXPECT_THAT(ErrorOf<InputError>(Request(server)), AllOf(HasSubstr("(401)"), HasSubstr("set HF_TOKEN")));
  EXPECT_THAT(ErrorOf<InputError>(Request(server)), AllOf(HasSubstr("(403)"), HasSubstr("agree to the license")));
  EXPECT_THAT(ErrorOf<InputError>(Request(server)), AllOf(HasSubstr("(404)"), HasSubstr("docs/models.md")));
  EXPECT_THAT(ErrorOf(Request(server)), AllOf(HasSubstr("(503)"), HasSubstr("the same command continues")));
  EXPECT_THAT(ErrorOf(Request(server)), HasSubstr("the server answers 418"));
}

TEST_F(DownloadTest, RefusesATooSmallDisk) {
  ScriptedServer server({Answer("200 OK", {"X-Linked-Size: 9000000000000000000"}, kBody)});
  EXPECT_THAT(ErrorOf(Request(server)),
              AllOf(HasSubstr("9000000000000 MB are needed, "), HasSubstr("set ORACLEGS_MODELS to another disk")));
}

}  // namespace
}  // namespace oraclegs
