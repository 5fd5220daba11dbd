#include "oraclegs/train/method_part.h"

#include "oraclegs/train/densify.h"

namespace oraclegs {

double RunParts(const MethodParts& parts, const Iteration& iteration, Densifier* densifier, TrainedModel* model,
                PartGradients* gradients) {
  const int64_t before = model->gaussians.size();
  for (const std::shared_ptr<MethodPart>& part : parts) part->Remove(iteration, model);
  if (model->gaussians.size() != before) densifier->Begin(model->gaussians.size());
  double loss = 0;
  for (const std::shared_ptr<MethodPart>& part : parts) loss += part->BeforeView(iteration, model, gradients);
  return loss;
}

}  // namespace oraclegs
