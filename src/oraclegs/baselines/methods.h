#pragma once
// The training of published methods: all that their authors' programs set. A new method is a new row.

#include <string>
#include <string_view>
#include <vector>

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

}  // namespace oraclegs
