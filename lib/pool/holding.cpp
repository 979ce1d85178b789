#include "lib/pool/holding.h"

#include <algorithm>
#include <limits>
#include <string>

#include <oneapi/tbb/global_control.h>
#include <oneapi/tbb/task_arena.h>

#include "lib/core/available_memory.h"
#include "lib/pool/block_cache.h"

namespace spool {
namespace {

using format::LayerInfo;
using format::SpoolReader;

// What reading a block takes for a moment: as it is stored, decoded, and the one before it, which
// the thread still looks at.
constexpr double kBlocksAThread = 3;

// Of what is left, for blocks that are kept; the rest is for what the heap loses between blocks and
// for pages of the file that the system reads ahead.
constexpr double kKeptShare = 0.5;

double reference_bytes(const SpoolReader& file) {
  double bytes = 0;
  for (const char* layer : {"reference", "reference_variance"}) {
    if (file.find_layer(layer)) {
      bytes += 3.0 * sizeof(double) * file.header().width * file.header().height;
    }
  }
  return bytes;
}

double block_bytes(const SpoolReader& file, const LayerInfo& layer) {
  const LayerGrid grid = layer_grid(file.header());
  const auto samples = static_cast<double>(grid.tile(0).area()) * grid.samples(0);
  return samples * layer.channel_count * sizeof(float);
}

double bytes_free(std::uint64_t to_be_mapped) {
  const auto bytes = available_memory(to_be_mapped);
  return bytes ? static_cast<double>(*bytes) : std::numeric_limits<double>::infinity();
}

// What is wanted beside the blocks, of blocks in memory and in the mapped file, and while blocks
// are read.
struct Demand {
  double fixed = 0, decoded = 0, mapped = 0, reading = 0;
  double channels = 0;
};

Demand demand_of(const SpoolReader& file, const std::vector<LayerInfo>& layers,
                 const WorkingMemory& work) {
  Demand demand;
  demand.fixed = reference_bytes(file) + work.fixed +
                 work.per_pixel * file.header().width * file.header().height;
  using oneapi::tbb::global_control;
  const auto allowed = global_control::active_value(global_control::max_allowed_parallelism);
  const auto threads = static_cast<double>(std::min<std::size_t>(
      allowed, static_cast<std::size_t>(oneapi::tbb::this_task_arena::max_concurrency())));
  for (const LayerInfo& layer : layers) {
    const auto all = static_cast<double>(unmapped_bytes(file, layer, FileAccess::kRead));
    const auto decoded = static_cast<double>(unmapped_bytes(file, layer, FileAccess::kMap));
    demand.decoded += decoded;
    demand.mapped += all - decoded;
    demand.reading += threads * kBlocksAThread * block_bytes(file, layer);
    demand.channels += layer.channel_count;
  }
  return demand;
}

}  // namespace

Result<Holding> choose_holding(const SpoolReader& file, const std::vector<LayerInfo>& layers,
                               const WorkingMemory& work) {
  SPOOL_TRY(check_memory_limit());
  const Demand demand = demand_of(file, layers, work);
  const double in_place = demand.fixed + demand.decoded, reading = demand.fixed + demand.reading;
  const double free_of_maps = bytes_free(0), free_beside_map = bytes_free(file.file_bytes());
  if (in_place <= free_beside_map && in_place + demand.mapped <= free_of_maps) return Holding{};
  if (reading <= free_of_maps) {
    return Holding{FileAccess::kRead, static_cast<std::uint64_t>(
                                          kKeptShare * (free_of_maps - reading) / demand.channels)};
  }
  // The system takes mapped pages back when it must.
  if (in_place <= free_beside_map) return Holding{};
  const std::string in_blocks =
      reading < in_place ? fmt::format(", or {:.3g} GB read block by block", reading / 1e9) : "";
  return fail(ErrorCode::kData,
              "{}: needs about {:.3g} GB of memory{}, {:.3g} GB are free: crop it, or raise the "
              "limit, or use a larger machine",
              file.path().string(), in_place / 1e9, in_blocks,
              std::min(free_of_maps, free_beside_map) / 1e9);
}

LayerBlocks held_layer(const std::shared_ptr<const SpoolReader>& file, const LayerInfo& layer,
                       const Holding& holding) {
  const LayerGrid grid = layer_grid(file->header());
  const int channels = static_cast<int>(layer.channel_count);
  BlockReader reader = file_blocks(file, layer, holding.access);
  if (holding.keep()) return {grid, channels, std::move(reader), file_pieces(file, layer)};
  reader =
      cached_blocks(std::move(reader), grid, channels, channels * holding.cache_bytes_a_channel);
  return {grid, channels, std::move(reader)};
}

}  // namespace spool
