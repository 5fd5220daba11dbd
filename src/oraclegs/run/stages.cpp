#include "oraclegs/run/stages.h"

#include "oraclegs/output/report/run_document.h"
#include "oraclegs/proposers/proxy_models.h"
#include "oraclegs/stages/evaluate_stage.h"
#include "oraclegs/stages/stage_works.h"

namespace oraclegs {

const std::vector<Stage>& Stages() {
  // name, version, needs, work
  static const std::vector<Stage> stages = {
      {"masks", 1, {}, MasksStage()},        // of photos; other stages read them as files
      {"register", 2, {}, RegisterStage()},  // cameras of photos without poses
      {"sfm", 1, {"register"}, SfmStage()},
      {"poses", 1, {"sfm"}, PosesStage()},
      {"depth", 7, {"sfm", "poses"}, DepthStage()},
      {"proxies", 5, {"depth"}, ProxyStage()},
      {"propose", 3, {"depth", "proxies"}, ProposeStage()},
      {"validate", 5, {"propose"}, ValidateStage()},
      {"train", 4, {"sfm", "depth", "validate"}, TrainStage()},
      {"evaluate", 5, {"train"}, EvaluateStage()},
      {"report", 1, {"evaluate"}, ReportStage()},
  };
  return stages;
}

}  // namespace oraclegs
