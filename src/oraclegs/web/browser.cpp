#include "oraclegs/web/browser.h"

#include <fcntl.h>
#include <spawn.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <cstdlib>
#include <sstream>
#include <thread>

#include "oraclegs/core/files.h"
#include "oraclegs/core/text.h"

namespace oraclegs {
namespace {

constexpr std::chrono::milliseconds kTrial(500), kLook(20);

std::string Variable(const char* name) {
  const char* value = std::getenv(name);
  return value == nullptr ? "" : value;
}

}  // namespace

std::optional<std::vector<std::string>> BrowserCommand(const std::string& url) {
  const std::vector<std::string> commands = SplitTrimmed(Variable("BROWSER"), ':');
  if (commands.empty()) {
    const bool display = !Variable("DISPLAY").empty() || !Variable("WAYLAND_DISPLAY").empty();
    const std::string opener = FindProgram("xdg-open").string();
    if (!display || opener.empty()) return std::nullopt;
    return std::vector<std::string>{opener, url};
  }
  std::vector<std::string> words;
  bool placed = false;
  std::istringstream text(commands.front());
  for (std::string word; text >> word;) {
    if (const size_t at = word.find("%s"); at != std::string::npos) {
      word.replace(at, 2, url);
      placed = true;
    }
    words.push_back(word);
  }
  if (!placed) words.push_back(url);
  return words;
}

bool OpenBrowser(const std::string& url) {
  const auto words = BrowserCommand(url);
  if (!words) return false;
  std::vector<std::string> texts = *words;
  std::vector<char*> arguments;
  for (std::string& text : texts) arguments.push_back(text.data());
  arguments.push_back(nullptr);
  posix_spawn_file_actions_t files;
  posix_spawn_file_actions_init(&files);
  for (const int fd : {STDIN_FILENO, STDOUT_FILENO, STDERR_FILENO}) {
    posix_spawn_file_actions_addopen(&files, fd, "/dev/null", O_RDWR, 0);
  }
  posix_spawnattr_t attributes;
  posix_spawnattr_init(&attributes);
  posix_spawnattr_setflags(&attributes, POSIX_SPAWN_SETSID);  // Ctrl-C here does not close it
  pid_t child = 0;
  const int error = posix_spawnp(&child, arguments[0], &files, &attributes, arguments.data(), environ);
  posix_spawnattr_destroy(&attributes);
  posix_spawn_file_actions_destroy(&files);
  if (error != 0) return false;
  const auto deadline = std::chrono::steady_clock::now() + kTrial;
  while (std::chrono::steady_clock::now() < deadline) {
    int status = 0;
    if (waitpid(child, &status, WNOHANG) == child) return WIFEXITED(status) && WEXITSTATUS(status) == 0;
    std::this_thread::sleep_for(kLook);
  }
  return true;
}

}  // namespace oraclegs
