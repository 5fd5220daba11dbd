#pragma once
// The training of published methods: all that their authors' programs set. A new method is a new row.

#include <string>
#include <string_view>
#include <vector>

#include "oraclegs/baselines/baseline_setup.h"
#include "oraclegs/baselines/settings.h"
#include "oraclegs/train/options.h"

namespace oraclegs {

/// Training options of 3DGS-MCMC [Kheradmand 2024] as its authors have them, on which every row builds. Each option is
/// set here, so that a new default of this program's changes no published method.
AutoTrainOptions Published3dgs();

struct BaselineMethod {
  std::string word;           ///< for --set method=WORD: "cor-gs", or "cor-gs-dtu" for the settings of one dataset
  AutoTrainOptions train;     ///< the trainer's options
  BaselineSettings own = {};  ///< what the method has beside them
};

const std::vector<BaselineMethod>& BaselineMethods();

/// The row of this word. Throws UsageError that lists the words, with the nearest one.
const BaselineMethod& FindBaseline(std::string_view word);

/// The row of a method for a dataset: "cor-gs-dtu" for "cor-gs" and "dtu", where its authors have such settings, else
/// "cor-gs". Throws as FindBaseline.
const BaselineMethod& BaselineFor(const std::string& method, const std::string& dataset);

/// Throws UsageError where the settings of a method contradict each other or the options of its training, so that none
/// is ignored silently. method: its name, for the message.
void CheckBaseline(std::string_view method, const BaselineSettings& settings, const AutoTrainOptions& options);

/// Makes the method's densifier and parts, and weighs the photos where it does so. Throws as their constructors.
void AddBaseline(BaselineSetup* setup);

}  // namespace oraclegs
