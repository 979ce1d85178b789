#include "formats/interchange/dump_import.h"

#include <algorithm>

#include "formats/byte_io.h"
#include "formats/checked_math.h"
#include "formats/dump_geometry.h"
#include "formats/geometry_rules.h"
#include "formats/half_float.h"
#include "formats/interchange/import_watch.h"
#include "formats/interchange/layer_names.h"
#include "formats/spool_writer.h"
#include "formats/target_watch.h"

namespace spool::interchange {
namespace {

using format::DataType;
using format::DumpGeometry;
using format::DumpHeader;
using format::GroupLayout;
using format::Scope;
using format::SpoolWriter;

constexpr uint64_t kTileBytes = uint64_t{64} << 20;  // of the blocks that are made at a time
constexpr uint64_t kBoxBytes = uint64_t{256} << 10;  // of rows of a source, in the cache
constexpr uint32_t kDefaultBlockSpp = 16;

// Layers in file order, each with its group; sorts plan.layers accordingly.
std::vector<uint16_t> assign_groups(std::vector<ForeignLayer>& layers) {
  const auto key = [](const ForeignLayer& layer) {
    return std::pair(stored_type(layer.array.type), layer.scope);
  };
  const bool share = layers.size() > format::kMaxGroups;
  if (share)
    std::stable_sort(layers.begin() + 1, layers.end(),
                     [&](const auto& a, const auto& b) { return key(a) < key(b); });
  std::vector<uint16_t> groups = {0};
  for (size_t i = 1; i < layers.size(); ++i) {
    const bool same = share && i > 1 && key(layers[i]) == key(layers[i - 1]);
    groups.push_back(static_cast<uint16_t>(groups.back() + (same ? 0 : 1)));
  }
  return groups;
}

// Blocks of a whole recording, as the limit of spool.md 6 counts them.
uint64_t total_blocks(const DumpHeader& header) {
  const uint64_t tiles = format::divide_up(header.width, header.tile_size) *
                         format::divide_up(header.height, header.tile_size);
  const uint64_t blocks = format::divide_up(header.spp, header.block_spp);
  uint64_t total = 0;
  for (size_t i = 0; i < header.channels.size(); ++i) {
    if (i > 0 && header.channels[i].group == header.channels[i - 1].group) continue;
    const Scope scope = header.channels[i].scope;
    total += scope == Scope::kPixel ? tiles : scope == Scope::kPass ? blocks : tiles * blocks;
  }
  return total;
}

DumpHeader make_header(const DumpPlan& plan, const std::vector<uint16_t>& groups,
                       const ImportOptions& options) {
  DumpHeader header;
  header.width = plan.width;
  header.height = plan.height;
  header.spp = plan.spp;
  header.tile_size = options.tile_size;
  header.sample_order = plan.sample_order;
  for (size_t i = 0; i < plan.layers.size(); ++i) {
    const ForeignLayer& layer = plan.layers[i];
    const auto known = find_layer_name(layer.name);
    const auto semantic = known ? known->semantic : format::Semantic::kNotStated;
    for (size_t c = 0; c < layer.components.size(); ++c)
      header.channels.push_back(
          {layer.name + "." + layer.components[c], groups[i], stored_type(layer.array.type),
           layer.semantics.empty() ? static_cast<uint16_t>(semantic) : layer.semantics[c],
           layer.scope});
  }
  header.block_spp = options.block_spp != 0 ? options.block_spp : kDefaultBlockSpp;
  while (options.block_spp == 0 && header.tile_size != 0 &&
         header.block_spp < format::kMaxBlockSpp && total_blocks(header) > format::kMaxBlocks)
    header.block_spp *= 2;
  return header;
}

// Memory that is used again from tile to tile, and what is noticed on the way.
struct Scratch {
  std::vector<std::byte> box;                    // rows of a layer
  std::vector<std::vector<std::byte>> payloads;  // blocks of a tile
  ImportWatch watch;
};

// Blocks [block, last] of one tile of one group; their samples are [begin, end).
struct TilePart {
  uint16_t group = 0;
  uint32_t tile = 0, block = 0, last = 0;
  uint32_t begin = 0, end = 0;
  format::PixelRect rect;
};

// Errors would be debiased by it, and come out too large.
Result<void> check_variance(std::span<const std::byte> values, DataType type,
                            const format::PixelRect& rect, const std::string& source) {
  const uint64_t bytes = format::bytes_per_value(type);
  for (uint64_t i = 0; i < values.size() / bytes; ++i) {
    const float value = type == DataType::kFloat16
                            ? format::half_to_float(format::load<uint16_t>(values, 2 * i))
                            : format::load<float>(values, 4 * i);
    const uint64_t pixel = i % (uint64_t{rect.width()} * rect.height());
    if (value < 0)
      return fail(ErrorCode::kData,
                  "{}: reference_variance of pixel {},{} is {}: a variance is at least 0", source,
                  rect.x0 + pixel % rect.width(), rect.y0 + pixel / rect.width(), value);
  }
  return {};
}

// A layer's values, whose first channel is `channel` of the group, into the blocks of a tile.
Result<void> fill_layer(const DumpGeometry& geometry, const TilePart& part,
                        const ForeignLayer& layer, uint64_t channel, const std::string& source,
                        Scratch& scratch, ValueCounts& counts) {
  const format::PixelRect& rect = part.rect;
  const uint64_t pixels = uint64_t{rect.width()} * rect.height();
  const uint64_t row_bytes = uint64_t{rect.width()} * (part.end - part.begin) *
                             layer.array.stride() * element_bytes(layer.array.type);
  const auto rows =
      static_cast<uint32_t>(std::clamp<uint64_t>(kBoxBytes / row_bytes, 1, rect.height()));
  for (uint32_t y = rect.y0; y < rect.y1; y += rows) {
    const uint32_t y1 = std::min(y + rows, rect.y1);
    SPOOL_TRY(read_box(layer.array, {y, y1, rect.x0, rect.x1, part.begin, part.end}, scratch.box));
    for (uint32_t b = part.block; b <= part.last; ++b) {
      const uint32_t first = geometry.block_begin(part.group, b);
      const uint32_t count = geometry.block_count(part.group, b);
      const uint64_t plane =
          pixels * count * format::bytes_per_value(geometry.groups()[part.group].type);
      const auto out = std::span(scratch.payloads[b - part.block])
                           .subspan(channel * plane, layer.array.components * plane);
      const BoxPart box{uint64_t{rect.width()} * (y1 - y), uint64_t{rect.width()} * (y - rect.y0),
                        part.end - part.begin, first - part.begin, count};
      if (!to_planar(scratch.box, layer.array, box, pixels, out, counts))
        return fail(ErrorCode::kData,
                    "{}: {} holds a value beyond float32 (tile {}, samples {} to {}): scale it",
                    source, layer.name, part.tile, first, first + count - 1);
    }
  }
  const DataType type = geometry.groups()[part.group].type;
  if (layer.name != "reference_variance" || type == DataType::kUint32) return {};
  const uint64_t plane = scratch.payloads[0].size() / geometry.groups()[part.group].channel_count;
  return check_variance(
      std::span(scratch.payloads[0]).subspan(channel * plane, layer.array.components * plane), type,
      rect, source);
}

// All blocks of one tile of one group.
Result<void> write_tile(SpoolWriter& writer, const DumpGeometry& geometry, uint16_t group,
                        uint32_t tile, std::span<const ForeignLayer> layers,
                        const std::string& source, Scratch& scratch, ValueCounts& counts) {
  const GroupLayout& layout = geometry.groups()[group];
  TilePart part{group, tile, 0, 0, 0, 0, {}};
  part.rect =
      layout.scope == Scope::kPass ? format::PixelRect{0, 0, 1, 1} : geometry.tile_rect(tile);
  const uint64_t pixels = uint64_t{part.rect.width()} * part.rect.height();
  uint64_t widest = 1;  // source bytes of one sample of the widest layer
  for (const ForeignLayer& layer : layers)
    widest = std::max(widest, pixels * layer.array.stride() * element_bytes(layer.array.type));
  const uint64_t full = geometry.block_count(group, 0);
  const uint32_t step = static_cast<uint32_t>(std::max<uint64_t>(1, kTileBytes / (widest * full)));
  for (part.block = 0; part.block < layout.blocks; part.block += step) {
    part.last = std::min(layout.blocks, part.block + step) - 1;
    part.begin = geometry.block_begin(group, part.block);
    part.end = geometry.block_begin(group, part.last) + geometry.block_count(group, part.last);
    scratch.payloads.resize(part.last - part.block + 1);
    for (uint32_t b = part.block; b <= part.last; ++b)
      scratch.payloads[b - part.block].resize(geometry.raw_bytes(group, tile, b));
    uint64_t channel = 0;
    for (const ForeignLayer& layer : layers) {
      SPOOL_TRY(fill_layer(geometry, part, layer, channel, source, scratch, counts));
      channel += layer.array.components;
    }
    for (uint32_t b = part.block; b <= part.last; ++b)
      scratch.watch.add(part.rect, geometry.block_begin(group, b), geometry.block_count(group, b),
                        layout.type, layers, scratch.payloads[b - part.block]);
    for (uint32_t b = part.block; b <= part.last; ++b)
      SPOOL_TRY(writer.write_block(group, tile, geometry.block_begin(group, b),
                                   geometry.block_count(group, b),
                                   scratch.payloads[b - part.block]));
  }
  return {};
}

}  // namespace

std::optional<uint64_t> stored_bytes(const std::vector<ForeignLayer>& layers) {
  std::optional<uint64_t> total = 0;
  for (const ForeignLayer& layer : layers) {
    const SampleArray& array = layer.array;
    const auto bytes = format::checked_product(
        {array.width, array.height, array.samples, array.components,
         std::max<uint64_t>(element_bytes(array.type),
                            format::bytes_per_value(stored_type(array.type)))});
    total = total && bytes ? format::checked_add(*total, *bytes) : std::nullopt;
  }
  return total;
}

Result<ImportReport> write_dump(const std::filesystem::path& out, DumpPlan plan,
                                const ImportOptions& options) {
  const std::string source = plan.record.files.empty() ? out.string() : plan.record.files[0].name;
  uint64_t source_bytes = 0;
  for (const ForeignFile& file : plan.record.files) {
    SPOOL_TRY(format::refuse_own_input(out, file.path));
    source_bytes += file.bytes;
  }
  SPOOL_TRY(options.expansion.check(source, stored_bytes(plan.layers), source_bytes));
  for (const ForeignLayer& layer : plan.layers)
    if (is_reference_layer(layer.name) && layer.scope != Scope::kPixel)
      return fail(
          ErrorCode::kData,
          "{}: {} has a value for each sample, and a recording has one for each pixel: leave "
          "it out, or give one picture",
          source, layer.name);
  const std::vector<uint16_t> groups = assign_groups(plan.layers);
  const DumpHeader header = make_header(plan, groups, options);
  if (const auto valid = format::check_channels(header.channels); !valid)
    return fail(ErrorCode::kData, "{}: {}: mend it there", source, valid.error().what);
  format::WriterOptions writer_options;
  writer_options.compress = options.compress;
  writer_options.force = options.force;
  writer_options.uuid = options.uuid;
  writer_options.discard_unfinished = true;  // the source is still there
  SPOOL_ASSIGN(SpoolWriter writer, SpoolWriter::create(out, header, writer_options));
  const DumpGeometry geometry(writer.header());

  ImportReport report{plan.width, plan.height, plan.spp, {}, {}, {}};
  bool half = false;
  Scratch scratch{{}, {}, ImportWatch(plan)};
  for (const ForeignLayer& layer : plan.layers) {
    report.layers.push_back(layer.name);
    half = half || layer.array.type == ElementType::kFloat16;
  }
  plan.meta["import"] = to_json(plan.record, half);
  SPOOL_TRY(
      writer.write_meta(plan.meta.dump(-1, ' ', false, nlohmann::json::error_handler_t::replace)));
  for (size_t first = 0; first < plan.layers.size();) {
    size_t end = first;
    while (end < plan.layers.size() && groups[end] == groups[first])
      ++end;
    const auto members = std::span(plan.layers).subspan(first, end - first);
    for (uint32_t tile = 0; tile < geometry.groups()[groups[first]].tiles; ++tile)
      SPOOL_TRY(write_tile(writer, geometry, groups[first], tile, members, source, scratch,
                           report.counts));
    first = end;
  }
  SPOOL_TRY(scratch.watch.judge(source, plan.sample_order, writer, report.notes));
  SPOOL_TRY(writer.finish());
  if (report.counts.non_finite > 0)
    report.notes.push_back(fmt::format("values that are not finite, stored as they are: {}",
                                       report.counts.non_finite));
  if (report.counts.at_half_limit > 0)
    report.notes.push_back(
        fmt::format("values at the half-float limit, clamped by the renderer: {}",
                    report.counts.at_half_limit));
  return report;
}

}  // namespace spool::interchange
