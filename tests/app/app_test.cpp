#include "oraclegs/app/app.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <atomic>
#include <memory>

#include "app/fake_program.h"
#include "oraclegs/core/files.h"
#include "oraclegs/web/assets.h"
#include "support/wait_until.h"
#include "web/raw_client.h"

namespace oraclegs {
namespace {

using nlohmann::json;
using testing::AnyOf;
using testing::HasSubstr;
using testing::Not;
using testing::StartsWith;

/// A run that finishes at once.
constexpr const char* kQuickRun = R"(case "$1" in
reconstruct) mkdir -p "$OUT/live" "$OUT/report"; echo splat > "$OUT/point_cloud.ply"; echo page > "$OUT/report.html"
  echo '{"state": "finished"}' > "$OUT/live/state.json";;
info) echo '{"warnings": []}';;
export) echo exported > "$OUT";;
esac)";

class AppTest : public testing::Test {
 protected:
  void SetUp() override {
    if (!WebPagesBuilt()) GTEST_SKIP() << "the pages were not built: " << HowToBuildWebPages();
    server = std::make_unique<WebServer>(WebServerOptions{}, app.Handler());
    const std::string opened = Ask(server->port(), app.OpenPath());
    const size_t at = opened.find("Set-Cookie: ") + 12;
    cookie = "Cookie: " + opened.substr(at, opened.find(';', at) - at) + "\r\n";
  }

  std::string Origin() const { return "Origin: http://127.0.0.1:" + std::to_string(server->port()) + "\r\n"; }
  std::string Get(const std::string& path) const { return Ask(server->port(), path, "GET", cookie); }
  std::string Post(const std::string& path, const std::string& body, const std::string& headers) const {
    const RawClient client(server->port());
    client.Send("POST " + path + " HTTP/1.1\r\nHost: 127.0.0.1:" + std::to_string(server->port()) + "\r\n" + headers +
                "Content-Length: " + std::to_string(body.size()) + "\r\n\r\n" + body);
    return client.Receive();
  }
  std::string Post(const std::string& path, const std::string& body) const {
    return Post(path, body, cookie + Origin());
  }
  json PostJson(const std::string& path, const json& body) const {
    return json::parse(BodyOf(Post(path, body.dump())));
  }
  json Document(const std::string& id) const { return json::parse(BodyOf(Get("/api/projects/" + id))); }
  std::string NewProject() const { return PostJson("/api/projects", {{"name", "My garden"}}).at("id"); }
  /// A project with three photos whose run has finished.
  std::string FinishedProject() const {
    const std::string id = NewProject();
    for (const char* name : {"1.jpg", "2.jpg", "3.jpg"}) {
      Post("/api/projects/" + id + "/upload?name=" + name, std::string("\xff\xd8\xff\xe0 photo ") + name);
    }
    PostJson("/api/projects/" + id + "/start", {{"quality", "draft"}});
    EXPECT_TRUE(WaitUntil([&] { return Document(id)["state"] == "finished"; }));
    return id;
  }

  TempDir dir;
  std::atomic<bool> quit = false;
  App app{{dir / "library",
           WriteFakeProgram(dir.path(), kQuickRun),
           {{{"draft", "Draft"}, {"normal", "Normal"}}, {{"auto", "Fastest"}}, "normal"},
           {.keep_free = 0},
           [this] { quit = true; }}};
  std::unique_ptr<WebServer> server;
  std::string cookie;
};

TEST_F(AppTest, FromPhotosToADownload) {
  EXPECT_THAT(Get("/"), HasSubstr("app.js"));
  const std::string id = FinishedProject();
  const json document = Document(id);
  EXPECT_EQ(document["name"], "My garden");
  EXPECT_EQ(document["photos"], 3);
  EXPECT_EQ(BodyOf(Get("/projects/" + id + "/photos/" + document["files"][0]["id"].get<std::string>())),
            "\xff\xd8\xff\xe0 photo 1.jpg");
  PostJson("/api/projects/" + id + "/edits", {{"min_support", .25}});
  PostJson("/api/projects/" + id + "/export", {{"format", "spz"}});
  EXPECT_TRUE(WaitUntil([&] { return Document(id)["exports"][0]["state"] == "done"; }));
  const std::string file = Get("/projects/" + id + "/exports/spz");
  EXPECT_EQ(BodyOf(file), "exported\n");
  EXPECT_THAT(file, HasSubstr("Content-Disposition: attachment; filename*=UTF-8''My%20garden.spz"));
  EXPECT_THAT(ReadFile(dir / "calls"), HasSubstr("--min-support 0.25"));
  PostJson("/api/projects/" + id + "/edits", {{"min_support", 0}});
  EXPECT_TRUE(Document(id)["exports"].empty()) << "it was of other edits";
}

TEST_F(AppTest, ARunIsShownByViewerAndReport) {
  const std::string id = FinishedProject();
  EXPECT_EQ(BodyOf(Get("/projects/" + id + "/view")), FindWebAsset("viewer.html")->bytes);
  EXPECT_EQ(BodyOf(Get("/projects/" + id + "/assets/viewer.js")), FindWebAsset("viewer.js")->bytes);
  EXPECT_THAT(BodyOf(Get("/projects/" + id + "/api/live")), HasSubstr("finished"));
  const std::string report = Get("/projects/" + id + "/report");
  EXPECT_EQ(BodyOf(report), "page\n");
  EXPECT_THAT(report, HasSubstr("Content-Security-Policy: sandbox allow-scripts"));
  EXPECT_THAT(report, Not(HasSubstr("allow-same-origin")));
  EXPECT_THAT(Get("/"), HasSubstr("frame-ancestors 'self'"));
}

TEST_F(AppTest, WithoutTheSecretThereIsNothing) {
  const std::string id = FinishedProject();
  for (const std::string& path :
       {std::string("/"), std::string("/api/library"), "/projects/" + id + "/view", "/api/projects/" + id,
        std::string("/assets/app.js"), std::string("/open/"), "/open/" + std::string(32, '0')}) {
    EXPECT_THAT(Ask(server->port(), path), StartsWith("HTTP/1.1 403 ")) << path;
  }
  EXPECT_THAT(Post("/api/projects", "{}", Origin()), StartsWith("HTTP/1.1 403 "));
  EXPECT_THAT(Post("/api/quit", "{}", Origin()), StartsWith("HTTP/1.1 403 "));
  EXPECT_FALSE(quit);
}

TEST_F(AppTest, OtherPagesChangeNothing) {
  for (const std::string& origin :
       {std::string(), std::string("Origin: null\r\n"), std::string("Origin: http://evil.example\r\n"),
        "Origin: http://127.0.0.1:" + std::to_string(server->port() + 1) + "\r\n"}) {
    EXPECT_THAT(Post("/api/projects", R"({"name": "evil"})", cookie + origin), StartsWith("HTTP/1.1 403 ")) << origin;
  }
  const RawClient client(server->port());
  client.Send("GET /api/library HTTP/1.1\r\nHost: evil.example\r\n" + cookie + "\r\n");
  EXPECT_THAT(client.Receive(), StartsWith("HTTP/1.1 403 "));
  EXPECT_TRUE(json::parse(BodyOf(Get("/api/library")))["projects"].empty());
}

TEST_F(AppTest, NoAddressLeadsOutOfTheLibrary) {
  const std::string id = FinishedProject();
  WriteText(dir / "library" / "secret" / "a.jpg", "secret");
  for (const std::string& path :
       {"/projects/" + id + "/files/../project.json", "/projects/" + id + "/files/%2e%2e/project.json",
        "/projects/" + id + "/files/point_cloud.ply", "/projects/" + id + "/photos/../../secret/a.jpg",
        "/projects/" + id + "/photos/1.jpg", "/projects/" + id + "/exports/../project.json",
        std::string("/projects/../secret/a.jpg"), std::string("/projects/secret/photos/a.jpg"),
        std::string("/projects/my-garden/view"), std::string("/files/etc/passwd"), std::string("/api/projects/.."),
        std::string("/assets/../app.html"), std::string("/assets/report.html")}) {
    const std::string answer = Get(path);
    EXPECT_THAT(answer, AnyOf(StartsWith("HTTP/1.1 404 "), StartsWith("HTTP/1.1 400 "))) << path;
    EXPECT_THAT(answer, Not(HasSubstr("secret"))) << path;
  }
}

TEST_F(AppTest, BadRequestsAreAnsweredInWords) {
  const std::string id = NewProject();
  const auto error = [&](const std::string& change, const std::string& body) {
    const std::string answer = Post("/api/projects/" + id + change, body);
    EXPECT_THAT(answer, StartsWith("HTTP/1.1 4")) << change << body;
    return BodyOf(answer);
  };
  EXPECT_THAT(error("/start", "{}"), HasSubstr("three photos"));
  EXPECT_THAT(error("/start", R"({"quality": "--out"})"), HasSubstr("no such choice"));
  EXPECT_THAT(error("/start", "[1]"), HasSubstr("no JSON object"));
  EXPECT_THAT(error("/rename", R"({"name": 3})"), HasSubstr("must be a text"));
  EXPECT_THAT(error("/rename", R"({"name": ""})"), HasSubstr("empty"));
  EXPECT_THAT(error("/export", R"({"format": "spz"})"), HasSubstr("no splat yet"));
  EXPECT_THAT(error("/export", R"({"format": "exe"})"), HasSubstr("no such format"));
  EXPECT_THAT(error("/edits", R"({"up": "--out"})"), HasSubstr("up"));
  EXPECT_THAT(error("/forget", R"({"file": "../x"})"), HasSubstr("no such file"));
  EXPECT_THAT(error("/pause", "{}"), HasSubstr("nothing runs"));
  EXPECT_THAT(error("/upload?name=a.jpg", "a text"), HasSubstr("neither a photo"));
  EXPECT_THAT(error("/frobnicate", "{}"), HasSubstr("not found"));
  EXPECT_THAT(Ask(server->port(), "/api/projects", "PUT", cookie + Origin()), StartsWith("HTTP/1.1 405 "));
  EXPECT_THAT(Post("/api/projects", std::string(1 << 20, ' ')), StartsWith("HTTP/1.1 413 "));
}

TEST_F(AppTest, AProjectIsRenamedAndDeleted) {
  const std::string id = NewProject();
  PostJson("/api/projects/" + id + "/rename", {{"name", "Zoë"}});
  EXPECT_EQ(Document(id)["name"], "Zoë");
  const json answer = PostJson("/api/projects/" + id + "/delete", {{"permanent", true}});
  EXPECT_TRUE(answer.contains("trash")) << answer;
  EXPECT_THAT(Get("/api/projects/" + id), StartsWith("HTTP/1.1 404 "));
}

TEST_F(AppTest, AFileIsTakenBack) {
  const std::string id = FinishedProject();
  const std::string file = Document(id)["files"][1]["id"];
  PostJson("/api/projects/" + id + "/forget", {{"file", file}});
  EXPECT_EQ(Document(id)["photos"], 2);
}

TEST_F(AppTest, LargeFilesArriveWhole) {
  const std::string id = NewProject();
  std::string large = "\xff\xd8\xff\xe0";
  for (int i = 0; i < 5'000'000; ++i) large += static_cast<char>(i * 2654435761u >> 13);
  EXPECT_THAT(Post("/api/projects/" + id + "/upload?name=a%20b.jpg", large), StartsWith("HTTP/1.1 201 "));
  const json document = Document(id);
  EXPECT_EQ(document["files"][0]["name"], "a b.jpg");
  EXPECT_EQ(BodyOf(Get("/projects/" + id + "/photos/" + document["files"][0]["id"].get<std::string>())), large);
}

TEST_F(AppTest, UnchangedDocumentsAreNotSentAgain) {
  const std::string first = Get("/api/library");
  const size_t at = first.find("ETag: ");
  ASSERT_NE(at, std::string::npos);
  const std::string tag = first.substr(at + 6, first.find("\r\n", at) - at - 6);
  EXPECT_THAT(Ask(server->port(), "/api/library", "GET", cookie + "If-None-Match: " + tag + "\r\n"),
              StartsWith("HTTP/1.1 304 "));
}

TEST_F(AppTest, ThePageCanEndIt) {
  EXPECT_FALSE(quit);
  PostJson("/api/quit", json::object());
  EXPECT_TRUE(quit);
}

}  // namespace
}  // namespace oraclegs
