#include "oraclegs/experiments/spread.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <map>

#include "oraclegs/workspace/part_store.h"
#include "run/proposing.h"

namespace oraclegs {
namespace {

namespace fs = std::filesystem;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;
using testing::SizeIs;

std::string ValueOf(const Job& job, const std::string& option) {
  const auto found = std::find(job.command.begin(), job.command.end(), option);
  return found == job.command.end() ? "" : *(found + 1);
}

/// Does in this process what the processes would do, but for those whose names `fails` has, and calls `after` with the
/// workspace when all are done.
class HereLauncher : public Launcher {
 public:
  using After = std::function<void(const fs::path& out)>;
  HereLauncher(const RunRequest& request, std::vector<std::string> fails, std::vector<Job>* seen, After after)
      : request_(request), fails_(std::move(fails)), seen_(seen), after_(std::move(after)) {}

  void Run(const std::vector<Job>& jobs, const std::function<void(size_t job, const JobResult& result)>& ended,
           const Listener&) override {
    for (size_t j = jobs.size(); j-- > 0;) {
      seen_->push_back(jobs[j]);
      JobResult result;
      if (std::find(fails_.begin(), fails_.end(), jobs[j].name) != fails_.end()) {
        result.end = JobEnd::kFailed, result.why = "no luck";
      } else {
        oraclegs::Run run = JoinRun(request_, Silent());
        MakeShare(&run, Stages(), ValueOf(jobs[j], "--stage"),
                  {ValueOf(jobs[j], "--key"), std::stoi(ValueOf(jobs[j], "--round")),
                   ParseShare(ValueOf(jobs[j], "--part")).value()});
      }
      ended(j, result);
    }
    if (after_) after_(request_.out);
  }

 private:
  RunRequest request_;
  std::vector<std::string> fails_;
  std::vector<Job>* seen_;
  After after_;
};

/// Makes a text of all that the parts below a workspace say, but for their keys.
void SpoilRecords(const fs::path& out) {
  for (const auto& entry : fs::recursive_directory_iterator(out / "parts")) {
    if (entry.path().filename() != "part.json") continue;
    nlohmann::json record = nlohmann::json::parse(ReadFile(entry.path()));
    for (auto& [name, value] : record.items()) {
      if (name != "key") value = "spoilt";
    }
    WriteFileAtomically(entry.path(), record.dump());
  }
}

/// Proposals, proxy models and confidence below a workspace, by path.
std::map<std::string, std::string> ResultsOf(const fs::path& out) {
  std::map<std::string, std::string> results;
  for (const char* folder : {"proposals", "confidence"}) {
    for (const auto& entry : fs::recursive_directory_iterator(out / folder)) {
      if (entry.is_regular_file()) results[entry.path().lexically_relative(out).string()] = ReadFile(entry.path());
    }
  }
  return results;
}

class SpreadTest : public ProposingTest {
 protected:
  /// A run up to a stage, divided among so many.
  void Make(const std::string& out, int spread, const std::string& stage, const std::vector<std::string>& fails = {}) {
    RunRequest request = Request(out);
    SpreadOptions options;
    options.spread = spread;
    request.options.propose.proposers = ProposerChoice::kSplat;
    request.options.trajectory.trajectory = Trajectory::kInterpolate;
    request.options.trajectory.proposals = 10;  // more than are classified together
    jobs.clear();
    request.spread = SpreadBy({options, "cpu", 1, "/bin/oraclegs"}, {}, [&](LauncherKind, const LaunchOptions& launch) {
      EXPECT_LE(launch.workers.value(), spread);
      return std::make_unique<HereLauncher>(request, fails, &jobs, after);
    });
    oraclegs::Run run = StartRun(request, recorder.AsListener());
    RunStage(&run, stage);
    record = run.workspace.Record(stage);
  }
  std::map<std::string, std::string> Validate(const std::string& out, int spread,
                                              const std::vector<std::string>& fails = {}) {
    Make(out, spread, "validate", fails);
    return ResultsOf(*temp / out);
  }

  std::vector<Job> jobs;
  HereLauncher::After after;
  nlohmann::json record;
};

TEST_F(SpreadTest, GivesTheSameFilesAsOneProcess) {
  const auto alone = Validate("alone", 1);
  EXPECT_THAT(jobs, IsEmpty());
  const nlohmann::json record_alone = record;
  recorder.steps.clear();
  const auto divided = Validate("divided", 2);
  EXPECT_THAT(jobs, SizeIs(6)) << "two processes for proxy models, proposals and confidence each";
  EXPECT_THAT(recorder.warnings,
              testing::Each(testing::AnyOf(HasSubstr("triangulated"), HasSubstr("depth is confident on"))))
      << "what COLMAP and stereo say of so small a scene";
  for (const StepDone& step : recorder.steps) {
    if (step.stage != "proxies" && step.stage != "propose") continue;
    EXPECT_EQ(step.unit, "processes") << "the run's own process takes what the others have made";
  }
  EXPECT_FALSE(alone.empty());
  EXPECT_TRUE(divided == alone);
  EXPECT_EQ(record.at("files"), record_alone.at("files"));
  EXPECT_EQ(record.at("mean_confidence"), record_alone.at("mean_confidence"));
  EXPECT_FALSE(fs::exists(*temp / "divided" / "parts" / "validate"));
}

TEST_F(SpreadTest, DoesItselfWhatAProcessFailsAt) {
  const auto alone = Validate("whole", 1);
  const auto divided = Validate("failing", 2, {"proxies 1/2", "propose 2/2, round 2", "validate 1/2"});
  EXPECT_TRUE(divided == alone);
  EXPECT_THAT(recorder.warnings, testing::Contains(HasSubstr("proxies 1/2: no luck")));
}

TEST_F(SpreadTest, MakesAgainWhatAPartDoesNotSayRightly) {
  const auto alone = Validate("one", 1);
  after = SpoilRecords;
  EXPECT_TRUE(Validate("spoilt", 2) == alone);
}

TEST_F(SpreadTest, StartsOneProcessForEachPartAtMost) {
  Make("many", 50, "proxies");
  EXPECT_THAT(jobs, SizeIs(3));
  const Job& job = jobs.front();
  EXPECT_EQ(job.name, "proxies 3/3");
  const std::string out = (*temp / "many").string();
  EXPECT_THAT(std::vector<std::string>(job.command.begin(), job.command.begin() + 3),
              ElementsAre("/bin/oraclegs", "share", out));
  EXPECT_EQ(ValueOf(job, "--device"), "cpu");
  EXPECT_EQ(ValueOf(job, "--threads"), "1");
  EXPECT_EQ(job.log, fs::path(out) / "parts" / "logs" / "proxies_0_3.log");
}

TEST_F(SpreadTest, RefusesSharesOfOtherInputs) {
  const RunRequest request = Request("refused");
  {
    oraclegs::Run run = StartRun(request, Silent());
    RunStage(&run, "depth");
  }
  oraclegs::Run joined = JoinRun(request, Silent());
  EXPECT_THAT(MessageOf<RunError>([&] {
                MakeShare(&joined, Stages(), "proxies", {"other", 0, {}});
              }),
              HasSubstr("finds other photos, weights or results"));
  EXPECT_THAT(MessageOf<UsageError>([&] {
                MakeShare(&joined, Stages(), "train", {"other", 0, {}});
              }),
              HasSubstr("train: is no stage that is done in parts"));
}

TEST_F(SpreadTest, NeedsMoreThanOneProcess) { EXPECT_FALSE(SpreadBy({{}, "cpu", 1, "oraclegs"}, {})); }

}  // namespace
}  // namespace oraclegs
