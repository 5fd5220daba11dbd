#include "oraclegs/validate/oracle.h"

namespace oraclegs {
namespace {

class UniformOracle : public Oracle {
 public:
  std::string name() const override { return "uniform"; }

  std::vector<ConfidenceMap> Predict(const std::vector<Query>& queries) const override {
    std::vector<ConfidenceMap> maps;
    for (const Query& query : queries) {
      const Camera& camera = query.proposal.camera;
      maps.emplace_back(static_cast<size_t>(camera.width) * static_cast<size_t>(camera.height), 1.f);
    }
    return maps;
  }
};

}  // namespace

std::unique_ptr<Oracle> MakeUniformOracle() { return std::make_unique<UniformOracle>(); }

}  // namespace oraclegs
