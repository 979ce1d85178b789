// The names of docs/method.md under which samplers hand over their intermediate images.
#include "lib/sampling/sampler.h"

namespace spool {

std::vector<ViewDescription> sampler_views(std::string_view name) {
  if (name == "multiscale") {
    return {
        {"f.k", "coarse images at the end (eqs 1-3)"},
        {"d.k", "detail images at the end (eq 4)"},
        {"V.k", "contrast of the regions at the end (eq 6)"},
        {"A.k", "attenuation at the end (eqs 7, 8)"},
        {"P.k", "priorities at the end (eq 5)"},
        {"f_initial.k", "coarse images after the first samples"},
        {"d_initial.k", "detail images after the first samples"},
        {"V_initial.k", "contrast after the first samples"},
        {"A_initial.k", "attenuation after the first samples"},
        {"P_initial.k", "priorities after the first samples"},
        {"samples.k", "samples that regions of level k took; 0: uniformly spent"},
    };
  }
  if (name == "mitchell") return {{"ratio", "largest contrast over its threshold, at the end"}};
  if (name == "greedy_error") {
    return {{"error.i", "relative error that more samples remove, iteration i"}};
  }
  if (name == "nl_means") return {{"error.i", "error before its smoothing, iteration i"}};
  if (name == "cross_bilateral") return {{"density.i", "what iteration i is apportioned over"}};
  if (name == "filtered_halves") {
    return {{"error.i", "relative difference of the two filtered halves, round i"}};
  }
  if (name == "neyman") return {{"deviation", "deviation of everything recorded"}};
  return {};
}

}  // namespace spool
