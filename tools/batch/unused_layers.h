// What a recording holds that no method of a plan reads: what the next recording could leave out.
#pragma once

#include <string>
#include <vector>

#include "lib/experiment/plan.h"

namespace spool::tools {

struct UnusedLayers {
  std::string recording;
  std::vector<std::string> layers;  // with a value for each sample
  double share = 0.0;               // of the bytes of a sample, before compression
};

// One entry for each recording that has such layers. Layers that no method could read - seeds of a
// sampler, say - are among them. A file that cannot be read has no entry: its reader reports it.
std::vector<UnusedLayers> unused_layers(const Plan& plan);

// "chess.spool: no method of the plan reads depth, film (31 % of the bytes of a sample)"; "" for
// none.
std::string unused_layers_text(const std::vector<UnusedLayers>& unused);

}  // namespace spool::tools
