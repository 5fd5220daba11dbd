#pragma once

#include <string_view>

#include "oraclegs/baselines/baseline_setup.h"

namespace oraclegs {

/// Throws UsageError where the settings of a method contradict each other or the options of its training, so that none
/// is ignored silently. method: its name, for the message.
void CheckBaseline(std::string_view method, const BaselineSettings& settings, const AutoTrainOptions& options);

/// Makes the method's densifier and parts, and weighs the photos where it does so. Throws as their constructors.
void AddBaseline(BaselineSetup* setup);

}  // namespace oraclegs
