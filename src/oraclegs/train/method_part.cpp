#include "oraclegs/train/method_part.h"

namespace oraclegs {

void MethodPart::Prune(const Iteration&, const Gaussians&, std::vector<bool>*) {}

}  // namespace oraclegs
