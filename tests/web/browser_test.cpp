#include "oraclegs/web/browser.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <chrono>
#include <cstdlib>
#include <thread>

#include "oraclegs/core/files.h"
#include "support/temp_dir.h"

namespace oraclegs {
namespace {

constexpr const char* kUrl = "http://127.0.0.1:7860/";

class BrowserTest : public testing::Test {
 protected:
  ~BrowserTest() override {
    for (const char* name : {"BROWSER", "DISPLAY", "WAYLAND_DISPLAY"}) unsetenv(name);
  }
};

TEST_F(BrowserTest, TakesTheUsersCommand) {
  setenv("BROWSER", "firefox --new-window %s:chromium", 1);
  EXPECT_THAT(BrowserCommand(kUrl).value(), testing::ElementsAre("firefox", "--new-window", kUrl));
  setenv("BROWSER", "chromium", 1);
  EXPECT_THAT(BrowserCommand(kUrl).value(), testing::ElementsAre("chromium", kUrl));
}

TEST_F(BrowserTest, OpensNoneWithoutADisplay) {
  for (const char* name : {"BROWSER", "DISPLAY", "WAYLAND_DISPLAY"}) unsetenv(name);
  EXPECT_FALSE(BrowserCommand(kUrl));
  EXPECT_FALSE(OpenBrowser(kUrl));
}

TEST_F(BrowserTest, SaysWhetherItStarted) {
  setenv("BROWSER", "/nonexistent/browser", 1);
  EXPECT_FALSE(OpenBrowser(kUrl));
  setenv("BROWSER", "false", 1);
  EXPECT_FALSE(OpenBrowser(kUrl));
  TempDir dir;
  WriteText(dir / "browser", "#!/bin/sh\nprintf %s \"$1\" > '" + (dir / "url").string() + "'\n");
  std::filesystem::permissions(dir / "browser", std::filesystem::perms::owner_all);
  setenv("BROWSER", (dir / "browser").c_str(), 1);
  EXPECT_TRUE(OpenBrowser(kUrl));
  EXPECT_EQ(ReadFile(dir / "url"), kUrl);
}

}  // namespace
}  // namespace oraclegs
