#include "oraclegs/core/process_group.h"

#include <fcntl.h>
#include <gtest/gtest.h>
#include <sys/syscall.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cerrno>
#include <csignal>
#include <fstream>
#include <optional>
#include <string>

#include "oraclegs/core/folder_lock.h"
#include "support/temp_dir.h"
#include "support/wait_until.h"

namespace {
bool g_kernel_is_old = false;
}  // namespace

/// Replaces the C library's call, so that a test can have a kernel without it.
extern "C" int close_range(unsigned first, unsigned last, int flags) noexcept {
  if (!g_kernel_is_old) return static_cast<int>(syscall(SYS_close_range, first, last, flags));
  errno = ENOSYS;
  return -1;
}

namespace oraclegs {
namespace {

using Variables = std::vector<std::pair<std::string, std::string>>;

/// The shell's script with its output thrown away.
class Script {
 public:
  explicit Script(const std::string& text, const Variables& variables = {})
      : argv_{"sh", "-c", text}, variables_(variables), null_(open("/dev/null", O_WRONLY | O_CLOEXEC)) {
    group_.emplace(ProgramStart{argv_, variables_, -1, null_, null_});
  }
  ~Script() { close(null_); }

  ProcessGroup& operator*() { return *group_; }
  ProcessGroup* operator->() { return &*group_; }

 private:
  std::vector<std::string> argv_;
  Variables variables_;
  int null_;
  std::optional<ProcessGroup> group_;
};

/// True when the process is gone, or a zombie that nobody has waited for.
bool IsGone(pid_t pid) {
  std::ifstream file("/proc/" + std::to_string(pid) + "/stat");
  std::string stat;
  return !std::getline(file, stat) || stat.find(") Z ") != std::string::npos;
}

/// The number that a script wrote.
pid_t PidIn(const std::filesystem::path& file) {
  pid_t pid = 0;
  WaitUntil([&] { return static_cast<bool>(std::ifstream(file) >> pid); });
  return pid;
}

TEST(ProcessGroup, TellsTheExitCode) {
  Script script("exit 7");
  EXPECT_EQ(script->start_error(), 0);
  EXPECT_TRUE(WaitUntil([&] { return script->HasEnded(); }));
  script->End();
  EXPECT_EQ(script->exit_code(), 7);
}

TEST(ProcessGroup, TellsWhyNothingStarts) {
  const std::vector<std::string> missing = {"oraclegs-no-such-program"}, folder = {"/"}, text = {"/etc/passwd"};
  EXPECT_EQ(ProcessGroup({missing, {}, -1, 1, 2}).start_error(), ENOENT);
  EXPECT_EQ(ProcessGroup({folder, {}, -1, 1, 2}).start_error(), EACCES);
  EXPECT_EQ(ProcessGroup({text, {}, -1, 1, 2}).start_error(), EACCES);
  const TempDir dir;
  WriteText(dir / "rubbish", "\x7f\x45no program");
  std::filesystem::permissions(dir / "rubbish", std::filesystem::perms::owner_all);
  const std::vector<std::string> rubbish = {(dir / "rubbish").string()};
  EXPECT_EQ(ProcessGroup({rubbish, {}, -1, 1, 2}).start_error(), ENOEXEC);
}

TEST(ProcessGroup, VariablesReplaceThoseOfTheEnvironment) {
  setenv("ORACLEGS_TEST_VARIABLE", "ours", 1);
  Script script("test \"$ORACLEGS_TEST_VARIABLE\" = theirs", {{"ORACLEGS_TEST_VARIABLE", "theirs"}});
  unsetenv("ORACLEGS_TEST_VARIABLE");
  EXPECT_TRUE(WaitUntil([&] { return script->HasEnded(); }));
  script->End();
  EXPECT_EQ(script->exit_code(), 0);
}

TEST(ProcessGroup, EndsChildrenThatAreLeftBehind) {
  const TempDir dir;
  pid_t grandchild = 0;
  {
    Script script("sleep 600 & echo $! > '" + (dir / "pid").string() + "'");
    EXPECT_TRUE(WaitUntil([&] { return script->HasEnded(); }));
    grandchild = PidIn(dir / "pid");
    ASSERT_GT(grandchild, 0);
    EXPECT_FALSE(IsGone(grandchild));
    script->End();
    EXPECT_EQ(script->exit_code(), 0);
  }
  EXPECT_TRUE(WaitUntil([&] { return IsGone(grandchild); }));
}

TEST(ProcessGroup, CountsComputingOnly) {
  Script waits("sleep 600"), computes("while true; do :; done");
  EXPECT_TRUE(WaitUntil([&] { return computes->CpuSeconds() > 0.1; }));
  EXPECT_LT(waits->CpuSeconds(), 0.1);
}

/// A process that starts a script and waits. It holds a lock on `dir`.
pid_t StartParent(const TempDir& dir, const std::string& text, bool kernel_is_old = false) {
  const pid_t parent = fork();
  if (parent != 0) return parent;
  g_kernel_is_old = kernel_is_old;
  const FolderLock lock(dir.path());
  Script script(text);
  while (true) pause();
}

void TestThatTheGroupDies(bool kernel_is_old) {
  const TempDir dir;
  const pid_t parent = StartParent(
      dir,
      "sleep 600 & echo $! > '" + (dir / "child").string() + "'; echo $$ > '" + (dir / "shell").string() + "'; wait",
      kernel_is_old);
  const pid_t shell = PidIn(dir / "shell"), child = PidIn(dir / "child");
  ASSERT_GT(shell, 0);
  ASSERT_GT(child, 0);
  EXPECT_TRUE(IsFolderLocked(dir.path()));
  kill(parent, SIGKILL);
  waitpid(parent, nullptr, 0);
  EXPECT_TRUE(WaitUntil([&] { return IsGone(shell) && IsGone(child); }));
  EXPECT_TRUE(WaitUntil([&] { return !IsFolderLocked(dir.path()); }));
}

TEST(ProcessGroup, DiesWithAParentThatIsKilled) { TestThatTheGroupDies(false); }

TEST(ProcessGroup, DiesWithItsParentOnKernelsThatCannotCloseManyFilesAtOnce) { TestThatTheGroupDies(true); }

/// Open files of a process, as the texts of their links.
std::vector<std::string> OpenFilesOf(pid_t pid) {
  std::vector<std::string> files;
  for (const auto& fd : std::filesystem::directory_iterator("/proc/" + std::to_string(pid) + "/fd")) {
    std::error_code gone;
    files.push_back(std::filesystem::read_symlink(fd, gone).string());
  }
  return files;
}

TEST(ProcessGroup, ItsGuardKeepsNoFileOpenOnSuchKernelsEither) {
  const TempDir dir;
  WriteText(dir / "open", "");
  const int first = open((dir / "open").c_str(), O_RDONLY);
  const int high = fcntl(first, F_DUPFD, 500);
  ASSERT_GE(high, 500);
  g_kernel_is_old = true;
  Script script("sleep 600");
  g_kernel_is_old = false;
  close(first), close(high);
  // The guard is the child of this process that is no shell.
  EXPECT_TRUE(WaitUntil([&] {
    std::ifstream children("/proc/self/task/" + std::to_string(gettid()) + "/children");
    int guards = 0, busy = 0;
    for (pid_t child = 0; children >> child;) {
      std::string name;
      std::getline(std::ifstream("/proc/" + std::to_string(child) + "/comm"), name);
      if (name != "guards-children") continue;
      ++guards;
      busy += OpenFilesOf(child).size() == 1 ? 0 : 1;
    }
    return guards == 1 && busy == 0;
  })) << "its pipe alone stays open";
}

TEST(ProcessGroup, APipeThatCannotBeGivenIsAnError) {
  const std::vector<std::string> argv = {"true"};
  EXPECT_EQ(ProcessGroup({argv, {}, -1, 12345, 2}).start_error(), EBADF);
}

TEST(ProcessGroup, KnowsTheLargestMemoryOfItsProgram) {
  const std::vector<std::string> argv = {"/bin/sh", "-c", "head -c 60000000 /dev/zero | tail -c 50000000 > /dev/null"};
  ProcessGroup group({argv, {}});
  ASSERT_EQ(group.start_error(), 0);
  EXPECT_TRUE(WaitUntil([&] { return group.HasEnded(); }));
  group.End();
  EXPECT_GT(group.peak_bytes(), 50'000'000) << "tail keeps that much";
}

TEST(ProcessGroup, KeepsTheLockUntilTheGroupIsGone) {
  const TempDir dir;
  int alive[2];
  ASSERT_EQ(pipe(alive), 0);  // the script's children keep its end open
  const pid_t parent = StartParent(dir, "echo $$ > '" + (dir / "shell").string() + "'; sleep 600 & sleep 600 & wait");
  close(alive[1]);
  ASSERT_GT(PidIn(dir / "shell"), 0);
  kill(parent, SIGKILL);
  waitpid(parent, nullptr, 0);
  WaitUntil([&] { return !IsFolderLocked(dir.path()); });
  EXPECT_FALSE(IsFolderLocked(dir.path()));
  const int flags = fcntl(alive[0], F_GETFL);
  fcntl(alive[0], F_SETFL, flags | O_NONBLOCK);
  char byte = 0;
  EXPECT_EQ(read(alive[0], &byte, 1), 0) << "something of the group lives, though the lock is free";
  close(alive[0]);
}

}  // namespace
}  // namespace oraclegs
