#include "oraclegs/experiments/bench/methods.h"

#include <algorithm>

#include "oraclegs/core/nearest_word.h"
#include "oraclegs/core/text.h"

namespace oraclegs {
namespace {

/// Rates and terms of 3DGS and the programs built on it, where this program's own differ.
RunArguments Plain3dgs() {
  return {{"proposers", "none"},    {"depth-prior", "stereo"}, {"depth-weight", "0"},
          {"alpha-weight", "0"},    {"opacity-noise", "0"},    {"dropout", "0"},
          {"largest-scale", "0"},   {"exposure", "off"},       {"prune-floaters", "false"},
          {"last-rates", "1"},      {"rate-scale", "1"},       {"sh-degree-interval", "1000"},
          {"refine-start", "500"},  {"refine-every", "100"},   {"init-scale", "0.1"},
          {"init-planes", "false"}, {"sh-moments", "full"},    {"frame", "scene"}};
}

/// Settings of methods with adaptive density control, which works on a CPU only.
RunArguments Adaptive() {
  return Overlaid(Plain3dgs(), {{"device", "cpu"},
                                {"densify", "adaptive"},
                                {"opacity-reg", "0"},
                                {"scale-reg", "0"},
                                {"refine-stop", "0.5"},
                                {"max-gaussians", "500000"},
                                {"init-scale", "1"},
                                {"init-opacity", "0.1"}});
}

/// Settings that the programs of FSGS, CoR-GS and DropGaussian share for few photos: fewer clones, densification until
/// the end, no size pruning.
RunArguments ForFewPhotos() {
  return Overlaid(Adaptive(), {{"densify-gradient", "0.0005"}, {"refine-stop", "1"}, {"keep-large", "true"}});
}

/// Start of the methods for few photos. They use COLMAP's dense points, this program stereo's; both see the training
/// views only.
RunArguments FromDensePoints(const std::string& iterations) { return {{"iterations", iterations}, {"init", "dense"}}; }

/// Settings of DNGaussian on LLFF and DTU.
RunArguments DnGaussianOfPhotos() {
  return {{"depth-step-every", "1"}, {"densify-opacity", "0.1"}, {"prune-opacity", "0.01"}};
}

}  // namespace

SuiteSettings Method::For(const std::string& suite) const {
  const auto own = of_suites.find(suite);
  if (own == of_suites.end()) return {options, usual};
  return {Overlaid(options, own->second.options), Overlaid(usual, own->second.usual)};
}

const std::vector<Method>& Methods() {
  static const std::vector<Method> methods = {
      {"ours", "OracleGS (this program)", "", {}, {}, ""},
      {"ours-no-proposals", "OracleGS without proposals", "", {{"proposers", "none"}}, {}, ""},
      {"3dgs", "3DGS", "Kerbl 2023", Adaptive(), FromDensePoints("10000"), ""},
      {"3dgs-mcmc", "3DGS-MCMC", "Kheradmand 2024", Plain3dgs(), FromDensePoints("10000"), ""},
      // The authors' training without points; the OracleGS paper's ablation begins with it.
      {"3dgs-mcmc-random",
       "3DGS-MCMC, random start",
       "Kheradmand 2024",
       Overlaid(Plain3dgs(), {{"depth-prior", "none"}, {"init", "random-cube"}}),
       {{"iterations", "10000"}},
       ""},
      {"dropgaussian", "DropGaussian", "Park 2025", Overlaid(ForFewPhotos(), {{"dropout", "0.2"}}),
       FromDensePoints("10000"), ""},
      {"fsgs",
       "FSGS",
       "Zhu 2024",
       Overlaid(ForFewPhotos(), {{"depth-prior", "auto"},
                                 {"depth-loss", "correlation"},
                                 {"depth-weight", "0.05"},
                                 {"pseudo-depth-weight", "0.05"},
                                 {"sh-degree-interval", "500"},
                                 {"opacity-reset-first", "2001"},
                                 {"opacity-reset-to", "0.05"},
                                 {"split-lonely", "true"},
                                 {"unpool-until", "2000"}}),
       FromDensePoints("10000"),
       "monocular depth; stereo's stands in for it",
       {{"llff", {{{"pseudo-depth-weight", "0.5"}, {"pseudo-depth-every", "1"}}}},
        {"mipnerf360", {{{"pseudo-depth-weight", "0.03"}}}}}},
      {"cor-gs",
       "CoR-GS",
       "Zhang 2024",
       Overlaid(ForFewPhotos(), {{"two-fields", "true"},
                                 {"sh-degree-interval", "500"},
                                 {"opacity-reset-first", "501"},
                                 {"opacity-reset-to", "0.05"},
                                 {"random-background", "true"},
                                 {"split-lonely", "true"}}),
       FromDensePoints("10000"),
       "",
       {{"dtu", {{{"co-prune-distance", "10"}, {"co-start", "2000"}}}},
        {"blender", {{{"random-background", "false"}}}},
        {"mipnerf360", {{{"co-prune-distance", "20"}, {"refine-stop", "0.5"}}, {{"iterations", "30000"}}}}}},
      {"dngaussian",
       "DNGaussian",
       "Li 2024",
       Overlaid(Adaptive(), {{"depth-prior", "auto"},
                             {"densify-gradient", "0.0005"},
                             {"refine-stop", "1"},
                             {"hard-depth", "true"},
                             {"soft-depth-start", "1000"},
                             {"depth-step-every", "10"},
                             {"depth-tolerance", "0.01"}}),
       FromDensePoints("6000"),
       "monocular depth; stereo's stands in for it",
       {{"llff", {Overlaid(DnGaussianOfPhotos(), {{"depth-tolerance", "0.00025"}, {"densify-gradient", "0.0013"}})}},
        {"dtu", {Overlaid(DnGaussianOfPhotos(), {{"densify-gradient", "0.001"}})}},
        {"blender", {{{"soft-depth-start", "0"}}}}}},
      // The published run has 30000 iterations, prunes at 20000 and densifies until 18000.
      {"sparsegs", "SparseGS", "Xiong 2023",
       Overlaid(Adaptive(), {{"depth-prior", "auto"},
                             {"depth-loss", "patched-correlation"},
                             {"depth-weight", "0.05"},
                             {"refine-stop", "0.6"},
                             {"prune-opacity", "0.05"},
                             {"prune-modes-at", "6667"}}),
       FromDensePoints("10000"), "monocular depth; stereo's stands in for it, and there is no diffusion model"},
      {"comapgs", "CoMapGS", "Jang 2025", Overlaid(ForFewPhotos(), {{"covisibility-weights", "true"}}),
       FromDensePoints("10000"), "matches of a network; the depth of stereo stands in for them"},
  };
  return methods;
}

std::vector<Method> FindMethods(const std::string& list) {
  std::vector<Method> found;
  std::vector<std::string> names;
  for (const Method& method : Methods()) names.push_back(method.name);
  for (const std::string& word : SplitTrimmed(list, ',')) {
    const auto at = std::find(names.begin(), names.end(), word);
    if (at == names.end()) {
      throw UsageError("--methods names '{}'; there are {}{}", word, fmt::join(names, ", "), DidYouMean(word, names));
    }
    const Method& method = Methods()[static_cast<size_t>(at - names.begin())];
    const bool again = std::any_of(found.begin(), found.end(), [&](const Method& m) { return m.name == method.name; });
    if (!again) found.push_back(method);
  }
  if (found.empty()) throw UsageError("--methods names none; there are {}", fmt::join(names, ", "));
  return found;
}

}  // namespace oraclegs
