#include "formats/pass_plan.h"

#include <algorithm>
#include <map>
#include <string>
#include <utility>

namespace spool::format {

namespace {

constexpr uint64_t kMaxBlockBytes = uint64_t{64} << 20;  // [spool.md 6]
constexpr uint64_t kMaxBlocks = uint64_t{1} << 19;

Semantic semantic_of(const std::string& layer) {
  static const std::map<std::string, Semantic> known = {
      {"radiance", Semantic::kLight},        {"direct", Semantic::kLight},
      {"albedo", Semantic::kReflectance},    {"albedo_ns", Semantic::kReflectance},
      {"normal", Semantic::kDirection},      {"normal_ns", Semantic::kDirection},
      {"position", Semantic::kPosition},     {"depth", Semantic::kDistance},
      {"depth_ns", Semantic::kDistance},     {"object", Semantic::kBits},
      {"lens", Semantic::kSampleCoordinate}, {"time", Semantic::kSampleCoordinate}};
  const auto found = known.find(layer);
  return found == known.end() ? Semantic::kNotStated : found->second;
}

DataType stored_type(const PassChannel& channel, bool radiance, const PackOptions& options) {
  if (radiance) return options.radiance_f16 ? DataType::kFloat16 : DataType::kFloat32;
  return options.features_f32 ? DataType::kFloat32 : channel.type;
}

void add_channel(DumpHeader& header, const std::string& name, uint16_t group, DataType type,
                 Semantic semantic, Scope scope) {
  header.channels.push_back({name, group, type, static_cast<uint16_t>(semantic), scope});
}

// Radiance, then what is stored as f16, then what is stored as f32.
void plan_sample_groups(const PassManifest& manifest, const PackOptions& options, DumpPlan& plan) {
  for (int wanted = 0; wanted < 3; ++wanted) {
    SampleGroup group{static_cast<uint16_t>(plan.groups.size()), DataType::kFloat32, {}};
    for (uint32_t i = 0; i < manifest.channels.size(); ++i) {
      const DataType type = stored_type(manifest.channels[i], i < 3, options);
      const int place = i < 3 ? 0 : type == DataType::kFloat16 ? 1 : 2;
      if (place != wanted) continue;
      const std::string& name = manifest.channels[i].name;
      add_channel(plan.header, name, group.group, type, semantic_of(name.substr(0, name.find('.'))),
                  Scope::kSample);
      group.type = type;
      group.planes.push_back(i);
    }
    if (!group.planes.empty()) plan.groups.push_back(std::move(group));
  }
}

void plan_other_groups(const PassManifest& manifest, DumpPlan& plan) {
  auto next = static_cast<uint16_t>(plan.groups.size());
  if (manifest.passes.front().has_film) {
    plan.film = next++;
    for (const char* name : {"film.X", "film.Y"}) {
      add_channel(plan.header, name, plan.film, DataType::kFloat32, Semantic::kSampleCoordinate,
                  Scope::kPass);
    }
  }
  plan.seed = next++;
  add_channel(plan.header, "seed.S", plan.seed, DataType::kUint32, Semantic::kBits, Scope::kPass);
  if (manifest.batches.empty()) return;
  plan.reference = next++;
  for (const char* name : {"reference.R", "reference.G", "reference.B"}) {
    add_channel(plan.header, name, plan.reference, DataType::kFloat32, Semantic::kLight,
                Scope::kPixel);
  }
  if (manifest.batch_seeds().size() < 2) return;  // one batch knows no variance
  for (const char* name :
       {"reference_variance.R", "reference_variance.G", "reference_variance.B"}) {
    add_channel(plan.header, name, plan.reference, DataType::kFloat32, Semantic::kLightVariance,
                Scope::kPixel);
  }
}

// 16 samples a block unless the band of one row of tiles, a block's limit or spp ask for fewer, or
// the number of records for more.
uint32_t choose_block_spp(const DumpPlan& plan, const PackOptions& options) {
  const DumpHeader& header = plan.header;
  if (options.block_spp != 0) return options.block_spp;
  const uint64_t tile_pixels = uint64_t{options.tile_size} * options.tile_size;
  uint64_t all = 0;
  uint64_t largest = 0;
  for (const SampleGroup& group : plan.groups) {
    all += group.bytes_per_sample();
    largest = std::max(largest, group.bytes_per_sample());
  }
  uint64_t count = 16;
  const uint64_t tiles = (uint64_t{header.width} + options.tile_size - 1) / options.tile_size *
                         ((uint64_t{header.height} + options.tile_size - 1) / options.tile_size);
  while (count < 1024 && tiles * plan.groups.size() * (header.spp / count) > kMaxBlocks)
    count *= 2;
  const uint64_t band = uint64_t{header.width} * options.tile_size * all;
  while (count > 1 &&
         (count * band > options.memory_bytes || count * tile_pixels * largest > kMaxBlockBytes)) {
    count /= 2;
  }
  return static_cast<uint32_t>(std::min<uint64_t>(count, header.spp));
}

}  // namespace

Result<DumpPlan> plan_dump(const PassManifest& manifest, const PackOptions& options) {
  if (manifest.passes.size() > 65536) {
    return fail(ErrorCode::kData, "{}: {} passes are more than a recording holds (65536)",
                manifest.folder.string(), manifest.passes.size());
  }
  DumpPlan plan;
  DumpHeader& header = plan.header;
  header.width = manifest.width;
  header.height = manifest.height;
  header.tile_size = options.tile_size;
  header.spp = static_cast<uint32_t>(manifest.passes.size());
  header.sample_order =
      manifest.mode == "sequence" ? SampleOrder::kRenderer : SampleOrder::kExchangeable;
  plan_sample_groups(manifest, options, plan);
  plan_other_groups(manifest, plan);
  header.block_spp = choose_block_spp(plan, options);
  return plan;
}

std::vector<Tile> tiles_of_band(const DumpHeader& header, uint32_t band) {
  const uint32_t across = (header.width + header.tile_size - 1) / header.tile_size;
  std::vector<Tile> tiles;
  for (uint32_t i = 0; i < across; ++i) {
    const uint32_t x0 = i * header.tile_size;
    const uint32_t y0 = band * header.tile_size;
    tiles.push_back({band * across + i, x0, y0, std::min(header.tile_size, header.width - x0),
                     std::min(header.tile_size, header.height - y0)});
  }
  return tiles;
}

}  // namespace spool::format
