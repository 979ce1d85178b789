// Many recordings of one distribution, each evaluated as `spool evaluate` does it.
#pragma once

#include <cstdint>
#include <functional>
#include <map>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "lib/experiment/experiment.h"
#include "lib/inference/intervals.h"
#include "lib/pool/recorded_samples.h"

namespace spool::bench {

struct World {
  std::string name;
  // Independent recordings of one scene.
  std::function<std::shared_ptr<const RecordedSamples>(std::uint64_t trial)> record;
};

struct Protocol {
  std::vector<std::pair<std::string, std::string>> methods;  // sampler, filter
  std::vector<double> spp;
  int replicates = 8;
  ReplicateOrder order = ReplicateOrder::kDisjoint;
  std::string metric = "relmse";
};

// [method][budget], with the samples that replicates share.
using Trial = std::vector<std::vector<Series>>;
Trial run_trial(const World& world, const Protocol& protocol, std::uint64_t trial);

// Scene S, with fireflies or not; `side` pixels a side.
World scene_s_world(int side, int samples, bool fireflies);
// Samples with a power-law tail of infinite variance on scene S.
World heavy_world(int side, int samples);
// The recorded samples of a window of a file as the distribution, drawn with replacement, and their
// mean as the truth.
World resampled_world(const std::string& path, int x, int y, int side, int samples);

}  // namespace spool::bench
