#include "oraclegs/app/session.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace oraclegs {
namespace {

using testing::HasSubstr;

class SessionTest : public testing::Test {
 protected:
  /// The cookie that a browser sends back.
  std::string Cookie() const {
    const std::string set = session.Open({"GET", session.path(), "127.0.0.1:7860"}, hosts).headers.at("Set-Cookie");
    return set.substr(0, set.find(';'));
  }
  bool Holds(const std::string& cookie) const {
    WebRequest request{"GET", "/", "127.0.0.1:7860"};
    request.cookie = cookie;
    return session.Holds(request, hosts);
  }

  Session session;
  AllowedHosts hosts{"127.0.0.1", 7860};
};

TEST_F(SessionTest, TheAddressGivesACookieThatOpens) {
  const WebAnswer answer = session.Open({"GET", session.path(), "127.0.0.1:7860"}, hosts);
  EXPECT_EQ(answer.status, 200);
  EXPECT_THAT(answer.body, HasSubstr("url=/"));
  EXPECT_THAT(answer.headers.at("Set-Cookie"), HasSubstr("; HttpOnly; SameSite=Strict"));
  EXPECT_TRUE(Holds(Cookie()));
  EXPECT_TRUE(Holds("a=b; " + Cookie() + "; c=d"));
}

TEST_F(SessionTest, NothingElseOpens) {
  const std::string cookie = Cookie();
  for (const std::string& wrong : {std::string(), cookie.substr(0, cookie.size() - 1), cookie + "0", "x" + cookie,
                                   cookie.substr(cookie.find('=') + 1), std::string("oraclegs-7860=")}) {
    EXPECT_FALSE(Holds(wrong)) << wrong;
  }
  for (const std::string& path : {std::string("/open/"), session.path() + "0", session.path().substr(0, 20)}) {
    const WebAnswer answer = session.Open({"GET", path, "127.0.0.1:7860"}, hosts);
    EXPECT_EQ(answer.status, 403);
    EXPECT_FALSE(answer.headers.contains("Set-Cookie"));
  }
}

TEST_F(SessionTest, EachStartHasItsOwnSecret) {
  const Session other;
  EXPECT_EQ(session.path().size(), std::string(Session::kPrefix).size() + 32);
  EXPECT_NE(session.path(), other.path());
  WebRequest request{"GET", "/", "127.0.0.1:7860"};
  request.cookie = Cookie();
  EXPECT_FALSE(other.Holds(request, hosts));
  EXPECT_FALSE(session.Holds(request, AllowedHosts("127.0.0.1", 7861))) << "the cookie of another port";
}

TEST_F(SessionTest, ChangesComeFromOwnPagesAlone) {
  WebRequest request{"POST", "/api/projects", "127.0.0.1:7860"};
  for (const char* origin : {"", "null", "http://evil.example", "https://127.0.0.1:7860", "http://127.0.0.1:7861",
                             "http://127.0.0.1:7860.evil.example", "http://127.0.0.1"}) {
    request.origin = origin;
    EXPECT_FALSE(Session::IsOwnPage(request)) << origin;
  }
  request.origin = "http://127.0.0.1:7860";
  EXPECT_TRUE(Session::IsOwnPage(request));
}

}  // namespace
}  // namespace oraclegs
