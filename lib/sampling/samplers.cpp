#include "lib/sampling/samplers.h"

#include "lib/sampling/adaptive_wavelet.h"
#include "lib/sampling/cross_bilateral.h"
#include "lib/sampling/cross_halves.h"
#include "lib/sampling/denoised_variance.h"
#include "lib/sampling/filtered_halves.h"
#include "lib/sampling/greedy_error.h"
#include "lib/sampling/mitchell.h"
#include "lib/sampling/multiscale/multiscale.h"
#include "lib/sampling/neyman.h"
#include "lib/sampling/nl_means.h"
#include "lib/sampling/uniform.h"

namespace spool {

const SamplerList& samplers() {
  static const SamplerList list = {
      "sampler",
      {uniform_sampler(), multiscale_sampler(), mitchell_sampler(), adaptive_wavelet_sampler(),
       greedy_error_sampler(), nl_means_sampler(), cross_bilateral_sampler(),
       denoised_variance_sampler(), filtered_halves_sampler(), cross_halves_sampler(),
       neyman_sampler()}};
  return list;
}

}  // namespace spool
