#include "oraclegs/experiments/spread.h"

#include <algorithm>
#include <thread>

namespace oraclegs {
namespace {

namespace fs = std::filesystem;

/// Of `count` processes at once on this machine; 0 where the machine is another one.
int ThreadsOf(const SpreadRequest& request, size_t count) {
  if (request.threads > 0 || request.options.launcher != LauncherKind::kLocal) return request.threads;
  return std::max(1, static_cast<int>(std::thread::hardware_concurrency() / count));
}

std::vector<Job> JobsOf(const SpreadRequest& request, const fs::path& out, const StageParts& parts) {
  const size_t count = std::min(static_cast<size_t>(request.options.spread), parts.count);
  std::vector<Job> jobs;
  for (size_t index = 0; index < count; ++index) {
    const std::string share = ToText({index, count});
    Job job;
    job.name =
        fmt::format("{} {}{}", parts.stage, share, parts.round > 0 ? fmt::format(", round {}", parts.round) : "");
    job.command = {request.program.string(), "share", out.string()};
    const auto add = [&](const char* name, std::string value) {
      job.command.insert(job.command.end(), {name, std::move(value)});
    };
    add("--stage", parts.stage), add("--round", std::to_string(parts.round)), add("--part", share);
    add("--key", parts.key), add("--device", request.device);
    add("--threads", std::to_string(ThreadsOf(request, count)));
    job.log = WorkspacePaths(out).parts() / "logs" / fmt::format("{}_{}_{}.log", parts.stage, parts.round, index + 1);
    jobs.push_back(std::move(job));
  }
  return jobs;
}

}  // namespace

std::function<void(Run*, const StageParts&)> SpreadBy(const SpreadRequest& request, const SlurmOptions& slurm,
                                                      const LauncherMaker& make_launcher) {
  if (request.options.spread < 2) return {};
  return [=](Run* run, const StageParts& parts) {
    const fs::path out = fs::absolute(run->workspace.root());
    const std::vector<Job> jobs = JobsOf(request, out, parts);
    LaunchOptions launch;
    launch.workers = static_cast<int>(jobs.size());
    launch.device = request.device;
    launch.slurm = slurm, launch.slurm_folder = WorkspacePaths(out).parts() / "slurm";
    size_t done = 0;
    const auto report = [&](const std::string& detail) {
      run->listener(
          StepDone{parts.stage, static_cast<int64_t>(done), static_cast<int64_t>(jobs.size()), "processes", detail});
    };
    report("");
    const auto ended = [&](size_t j, const JobResult& result) {
      ++done;
      report(jobs[j].name);
      if (result.end == JobEnd::kDone) return;
      run->listener(Warning{
          fmt::format("{}: {} ({}); this process does its work", jobs[j].name, result.why, jobs[j].log.string())});
    };
    make_launcher(request.options.launcher, launch)->Run(jobs, ended, run->listener);
  };
}

}  // namespace oraclegs
