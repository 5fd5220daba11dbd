#include "oraclegs/weights/http.h"

#include <gmock/gmock.h>

#include "environment.h"
#include "oraclegs/core/error.h"
#include "oraclegs/core/interrupt.h"
#include "scripted_server.h"

namespace oraclegs {
namespace {

using testing::AllOf;
using testing::HasSubstr;
using testing::Not;
using testing::StartsWith;
using testing::ThrowsMessage;

class Http : public testing::Test {
 protected:
  HttpEnd Get(const HttpRequest& request) {
    body_.clear();
    begun_ = 0;
    return HttpGet(request, {[&](const HttpReply&) { ++begun_; }, [&](std::string_view bytes) { body_ += bytes; }});
  }
  std::string body_;
  int begun_ = 0;

 private:
  ScopedVariable no_proxy_{"no_proxy", "127.0.0.1"};
};

TEST_F(Http, JoinsNoHeaderToThoseOfTheAnswerBefore) {
  ScriptedServer server({Answer("302 Found", {"Location: /b", "X-A: a"}), File("hello", {" folded: b"})});
  const HttpEnd end = Get({server.Url("/a")});  // libcurl reads what it has freed, as the address sanitizer sees
  EXPECT_EQ(end.reply.status, 200);
  EXPECT_EQ(end.reply.headers.at("x-a"), "a");
  EXPECT_EQ(body_, "hello");
}

TEST_F(Http, GetsAFileWithItsHeaders) {
  ScriptedServer server({File("hello", {"X-Linked-Size:  5 ", "ETag: \"a\""})});
  const HttpEnd end = Get({server.Url("/a?b=c")});
  EXPECT_EQ(body_, "hello");
  EXPECT_EQ(begun_, 1);
  EXPECT_EQ(end.reply.status, 200);
  EXPECT_EQ(end.dropped, "");
  EXPECT_EQ(end.reply.headers.at("etag"), "\"a\"");
  EXPECT_EQ(end.reply.Number("x-linked-size", 0), 5u);
  EXPECT_EQ(end.reply.Number("etag", 7), 7u);
  EXPECT_EQ(end.reply.Number("none", 7), 7u);
  EXPECT_THAT(server.Requests()[0],
              AllOf(StartsWith("GET /a?b=c HTTP/1.1\r\n"), Not(HasSubstr("Range:")), Not(HasSubstr("Authorization"))));
}

TEST_F(Http, AcceptsAnEmptyFile) {
  ScriptedServer server({File("")});
  Get({server.Url()});
  EXPECT_EQ(begun_, 1);
}

TEST_F(Http, AsksForTheRest) {
  ScriptedServer server({Answer("206 Partial Content", {"Content-Range: bytes 3-4/5", "Content-Length: 2"}, "lo")});
  EXPECT_EQ(Get({server.Url(), "", 3}).reply.status, 206);
  EXPECT_EQ(body_, "lo");
  EXPECT_THAT(server.Requests()[0], HasSubstr("Range: bytes=3-\r\n"));
}

TEST_F(Http, IgnoresTheBodyOfARefusal) {
  ScriptedServer server({Answer("404 Not Found", {"Content-Length: 4"}, "gone")});
  EXPECT_EQ(Get({server.Url()}).reply.status, 404);
  EXPECT_EQ(body_ + std::to_string(begun_), "0");
}

TEST_F(Http, FollowsRedirections) {
  ScriptedServer server({Answer("302 Found", {"Location: /next", "X-Linked-Size: 9", "Content-Length: 3"}, "no!"),
                         File("yes", {"X-Linked-Size: 3"})});
  const HttpEnd end = Get({server.Url(), "secret"});
  EXPECT_EQ(body_, "yes");
  EXPECT_EQ(end.reply.Number("x-linked-size", 0), 9u);
  EXPECT_EQ(end.reply.Number("content-length", 0), 3u);
  // The same server: it has the secret already.
  for (const std::string& request : server.Requests())
    EXPECT_THAT(request, HasSubstr("Authorization: Bearer secret\r\n"));
}

TEST_F(Http, KeepsTheSecretFromAnotherServer) {
  ScriptedServer other({File("yes")});
  ScriptedServer server({Answer("302 Found", {"Location: " + other.Url(), "Content-Length: 0"})});
  Get({server.Url(), "secret"});
  EXPECT_EQ(body_, "yes");
  EXPECT_THAT(server.Requests()[0], HasSubstr("Authorization: Bearer secret\r\n"));
  EXPECT_THAT(other.Requests()[0], AllOf(Not(HasSubstr("secret")), Not(HasSubstr("Authorization"))));
}

TEST_F(Http, KeepsTheSecretFromTheSecondRedirection) {
  ScriptedServer last({File("yes")});
  ScriptedServer middle({Answer("302 Found", {"Location: " + last.Url(), "Content-Length: 0"})});
  ScriptedServer server({Answer("307 Temporary Redirect", {"Location: " + middle.Url(), "Content-Length: 0"})});
  Get({server.Url(), "secret"});
  EXPECT_THAT(middle.Requests()[0] + last.Requests()[0], Not(HasSubstr("secret")));
}

TEST_F(Http, RefusesEndlessRedirections) {
  ScriptedServer loop(std::vector<std::string>(11, Answer("302 Found", {"Location: /file", "Content-Length: 0"})));
  EXPECT_THAT([&] { Get({loop.Url()}); }, ThrowsMessage<RunError>(HasSubstr("redirects more than 10 times")));
  ScriptedServer file({Answer("302 Found", {"Location: file:///etc/passwd", "Content-Length: 0"})});
  EXPECT_THROW(Get({file.Url()}), RunError);
  EXPECT_EQ(body_, "");
}

TEST_F(Http, KeepsWhatArrivedBeforeALostConnection) {
  ScriptedServer server({Answer("200 OK", {"Content-Length: 10"}, "half")});
  const HttpEnd end = Get({server.Url()});
  EXPECT_EQ(body_, "half");
  EXPECT_NE(end.dropped, "");
}

TEST_F(Http, NamesTheAddressWithoutItsQuery) {
  std::string url;
  { url = ScriptedServer({}).Url("/a?signature=xyz"); }
  EXPECT_THAT([&] { Get({url}); }, ThrowsMessage<RunError>(AllOf(HasSubstr("/a: no answer: "), HasSubstr("http_proxy"),
                                                                 Not(HasSubstr("xyz")))));
  EXPECT_THAT([&] { Get({"no address"}); }, ThrowsMessage<RunError>(HasSubstr("is no address of a server")));
}

TEST(WithoutSecrets, DropsWhatOthersMayNotSee) {
  EXPECT_EQ(WithoutSecrets("http://h/a?b#c"), "http://h/a");
  EXPECT_EQ(WithoutSecrets("https://h:8443/a"), "https://h:8443/a");
  EXPECT_EQ(WithoutSecrets("http://user:hunter2@h:80/a?b=c@d"), "http://h/a");
  for (const char* broken :
       {"user:hunter2@h/a", "http://user:hunter2#3@h/a", "http://user:hunt/er2@h/a", "http://user:hunter2@h:x/a"})
    EXPECT_THAT(WithoutSecrets(broken), AllOf(Not(HasSubstr("hunt")), HasSubstr("h"))) << broken;
}

TEST(OriginOf, ReadsAddressesAsLibcurlDoes) {
  EXPECT_EQ(OriginOf("HTTP://LocalHost:80/x").host, "localhost");
  EXPECT_EQ(OriginOf("http://localhost:x@host/").host, "host");
  EXPECT_TRUE(OriginOf("http://localhost:x@host/").has_user);
  EXPECT_TRUE(OriginOf("http://me@host/").has_user);
  EXPECT_FALSE(OriginOf("http://host/a@b").has_user);
  EXPECT_EQ(OriginOf("https://host/a").text, "https://host:443");
  EXPECT_EQ(OriginOf("no address").text, "");
}

TEST_F(Http, RethrowsWhatAHandlerThrows) {
  ScriptedServer server({File("hello"), File("hello")});
  const HttpHandlers full{[](const HttpReply&) {}, [](std::string_view) { throw InputError("disk full"); }};
  EXPECT_THROW(HttpGet({server.Url()}, full), InputError);
  const HttpHandlers refuses{[](const HttpReply&) { throw InputError("no"); }, [](std::string_view) {}};
  EXPECT_THROW(HttpGet({server.Url()}, refuses), InputError);
}

TEST_F(Http, StopsOnInterrupt) {
  ScriptedServer server({});
  RequestInterrupt(true);
  EXPECT_THROW(Get({server.Url()}), Interrupted);
  RequestInterrupt(false);
}

TEST_F(Http, UsesTheProxyOfTheEnvironment) {
  ScriptedServer proxy({File("from the proxy")});
  const ScopedVariable variable("http_proxy", proxy.Url(""));
  const ScopedVariable all("no_proxy", std::nullopt);
  Get({"http://models.invalid/file"});
  EXPECT_EQ(body_, "from the proxy");
  EXPECT_THAT(proxy.Requests()[0], StartsWith("GET http://models.invalid/file HTTP/1.1\r\n"));
}

}  // namespace
}  // namespace oraclegs
