#include "oraclegs/validate/oracle.h"

namespace oraclegs {
namespace {

class UniformOracle : public Oracle {
 public:
  std::string name() const override { return "uniform"; }

  std::vector<ConfidenceMap> Validate(const std::vector<Proposal>& proposals) const override {
    std::vector<ConfidenceMap> maps;
    for (const Proposal& p : proposals) {
      maps.emplace_back(static_cast<size_t>(p.camera.width) * static_cast<size_t>(p.camera.height), 1.f);
    }
    return maps;
  }
};

}  // namespace

std::unique_ptr<Oracle> MakeUniformOracle() { return std::make_unique<UniformOracle>(); }

}  // namespace oraclegs
