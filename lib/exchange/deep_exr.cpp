#include "lib/exchange/deep_exr.h"

#include <algorithm>
#include <cstring>

#include "formats/byte_io.h"
#include "formats/file_set.h"
#include "formats/half_float.h"
#include "formats/interchange/layer_names.h"
#include "formats/temporary_file.h"
#include "lib/core/random.h"
#include "lib/core/visible_text.h"
#include "lib/exchange/pixel_layers.h"
#include "lib/image_io/colour_space.h"
#include "lib/image_io/deep_exr_file.h"
#include "lib/image_io/exr_layers.h"
#include "lib/image_io/exr_source.h"

namespace spool::exchange {

using format::FileHandle;
using format::LayerInfo;
using format::load;
using format::Scope;
using format::store;
using interchange::DumpPlan;
using interchange::ExportReport;
using interchange::ForeignLayer;
using interchange::ImportReport;

namespace {

struct DeepImportOptions : interchange::ImportOptions {
  // Take a file of another tool: R, G, B and Z. Its samples may be sorted by depth, so each pixel
  // is shuffled with a fixed seed.
  bool foreign_samples = false;
};

constexpr const char* kIndexChannel = "spool.index";
constexpr const char* kDepthChannel = "Z";
constexpr uint64_t kMaxChunkBytes = (uint64_t{1} << 31) - 1;
constexpr uint64_t kShuffleSeed = 20;

// values [x][s][c] of a layer's row -> [x][s] of each component.
void split_row(std::span<const std::byte> row, uint64_t channels, uint64_t bytes,
               std::vector<std::vector<std::byte>>& out) {
  const uint64_t count = row.size() / (channels * bytes);
  for (uint64_t c = 0; c < channels; ++c) {
    std::vector<std::byte>& values = out.emplace_back(count * bytes);
    for (uint64_t i = 0; i < count; ++i)
      std::memcpy(&values[i * bytes], &row[(i * channels + c) * bytes], bytes);
  }
}

Result<std::vector<std::byte>> row_of(const ScratchLayers& scratch, const ScratchLayer& stored,
                                      const format::DumpHeader& header, uint64_t y) {
  const uint64_t value =
      uint64_t{stored.layer.channel_count} * format::bytes_per_value(stored.layer.type);
  const uint64_t pixel = value * header.spp;
  std::vector<std::byte> row(pixel * header.width);
  if (stored.layer.scope == Scope::kSample) {
    SPOOL_TRY(scratch.file.read_at(stored.offset + y * row.size(), row));
    return row;
  }
  SPOOL_TRY(scratch.file.read_at(stored.offset, std::span(row).first(pixel)));
  for (uint64_t x = 1; x < header.width; ++x)
    std::memcpy(&row[x * pixel], row.data(), pixel);
  return row;
}

// "a/b.exr" -> "a/b.pixel.exr"
std::filesystem::path pixel_file_of(std::filesystem::path deep) {
  return deep.replace_extension(".pixel.exr");
}

Result<DeepHeader> deep_header(const format::SpoolReader& dump) {
  const format::DumpHeader& header = dump.header();
  DeepHeader deep{
      static_cast<int>(header.width), static_cast<int>(header.height), {}, describe_dump(dump)};
  uint64_t sample_bytes = 8;
  for (const LayerInfo& layer : dump.layers()) {
    if (layer.scope == Scope::kPixel) continue;
    if (layer.name == "spool" && std::ranges::count(layer.components, "index") > 0)
      return fail(ErrorCode::kData,
                  "{}: layer spool has a component index, where deep-exr keeps the numbers of the "
                  "samples: export another format",
                  dump.path().string());
    for (const std::string& component : layer.components)
      deep.channels.push_back({layer.name + "." + component, pixel_type(layer.type)});
    sample_bytes += uint64_t{layer.channel_count} * format::bytes_per_value(layer.type);
  }
  deep.channels.push_back({kDepthChannel, PixelType::kFloat});
  deep.channels.push_back({kIndexChannel, PixelType::kUint});
  if (sample_bytes * header.spp * header.width > kMaxChunkBytes)
    return fail(ErrorCode::kData,
                "{}: a row of {} samples takes more than OpenEXR's 2 GiB: export fewer samples",
                dump.path().string(), header.spp);
  return deep;
}

Result<void> write_samples(const DeepHeader& deep, const format::DumpHeader& header,
                           const ScratchLayers& scratch, const std::filesystem::path& path) {
  SPOOL_ASSIGN(DeepExrWriter writer, DeepExrWriter::create(path, deep, header.spp, false));
  std::vector<std::byte> depth(size_t{4} * header.width * header.spp), index = depth;
  for (size_t i = 0; i < size_t{header.width} * header.spp; ++i) {
    const auto s = static_cast<uint32_t>(i % header.spp);
    store(std::span(depth), 4 * i, static_cast<float>(s));
    store(std::span(index), 4 * i, s);
  }
  for (uint64_t y = 0; y < header.height; ++y) {
    std::vector<std::vector<std::byte>> values;
    for (const ScratchLayer& stored : scratch.layers) {
      if (stored.layer.scope == Scope::kPixel) continue;
      SPOOL_ASSIGN(const auto row, row_of(scratch, stored, header, y));
      split_row(row, stored.layer.channel_count, format::bytes_per_value(stored.layer.type),
                values);
    }
    values.push_back(depth);
    values.push_back(index);
    SPOOL_TRY(writer.write_row(values));
  }
  return writer.finish();
}

Result<ExportReport> export_deep_exr(const std::filesystem::path& in,
                                     const std::filesystem::path& out,
                                     const interchange::ExportOptions& options) {
  SPOOL_TRY(format::refuse_existing_target(out, options.force));
  SPOOL_ASSIGN(const format::SpoolReader dump, format::SpoolReader::open(in));
  SPOOL_TRY(require_complete(dump));
  SPOOL_ASSIGN(const DeepHeader deep, deep_header(dump));
  const std::string samples = out.filename().string(),
                    pixels = pixel_file_of(out).filename().string();
  const bool has_pixels = std::ranges::count(dump.layers(), Scope::kPixel, &LayerInfo::scope) > 0;
  std::vector<std::string> names = {samples};
  if (has_pixels) names.push_back(pixels);
  // Before the layers are unpacked: what another process writes here meanwhile is not replaced.
  SPOOL_ASSIGN(format::FileSet set,
               format::FileSet::create(out.parent_path(), names, options.force, {in}));
  SPOOL_ASSIGN(ScratchLayers scratch, unpack_layers(dump, out));
  SPOOL_TRY(set.write(samples, [&](const std::filesystem::path& path) {
    return write_samples(deep, dump.header(), scratch, path);
  }));
  ExportReport report;
  if (has_pixels) {
    SPOOL_TRY(set.write(pixels, [&](const std::filesystem::path& path) {
      return write_pixel_layers(dump, scratch, path);
    }));
    report.notes.push_back("layers with one value per pixel are in " + pixels);
  }
  SPOOL_TRY(set.publish());
  return report;
}

// A layer of the recording to be, and where its components are among the deep channels.
struct Wanted {
  ForeignLayer layer;
  std::vector<size_t> channels;
};

struct DeepInput {
  std::string name;
  DeepExrReader reader;
  std::optional<ToldDump> told;
  std::vector<Wanted> wanted;
  uint32_t spp = 0;

  std::optional<size_t> channel(std::string_view wanted_name) const {
    const auto& channels = reader.header().channels;
    for (size_t c = 0; c < channels.size(); ++c)
      if (channels[c].name == wanted_name) return c;
    return std::nullopt;
  }
};

Result<void> want(DeepInput& input, const std::string& layer, const std::string& component,
                  const std::string& theirs, Scope scope) {
  const auto at = input.channel(theirs);
  if (!at && !input.told) {
    std::vector<std::string> names;
    for (const auto& channel : input.reader.header().channels)
      names.push_back(channel.name);
    return fail(ErrorCode::kData, "{}: no channel {}, there are {}: name the colours R, G, B",
                input.name, theirs, listed(names));
  }
  if (!at)
    return fail(ErrorCode::kData, "{}: no channel {}: was it dropped by a tool?", input.name,
                theirs);
  const PixelType type = input.reader.header().channels[*at].type;
  if ((!input.told || layer == "radiance") && type == PixelType::kUint)
    return fail(ErrorCode::kData,
                "{}: channel {} holds whole numbers (uint), {} has half or float: decode it first",
                input.name, theirs, layer);
  if (input.wanted.empty() || input.wanted.back().layer.name != layer)
    input.wanted.push_back({{layer,
                             {},
                             scope,
                             {},
                             input.told ? input.told->semantics(layer) : std::vector<uint16_t>()},
                            {}});
  Wanted& wanted = input.wanted.back();
  if (!wanted.channels.empty() && input.reader.header().channels[wanted.channels[0]].type != type)
    return fail(ErrorCode::kData, "{}: the components of {} have different types: save them alike",
                input.name, layer);
  wanted.layer.components.push_back(component);
  wanted.layer.array.type = element_type(type);
  wanted.channels.push_back(*at);
  return {};
}

Result<void> plan_channels(DeepInput& input) {
  if (input.told) {
    for (const ToldChannel& channel : input.told->channels) {
      if (channel.scope == Scope::kPixel) continue;
      if (channel.name() == kIndexChannel)
        return fail(ErrorCode::kData,
                    "{}: its layer spool.index was lost in the export: export another format",
                    input.name);
      SPOOL_TRY(want(input, channel.layer, channel.component, channel.name(), channel.scope));
    }
    const auto index = input.channel(kIndexChannel);
    if (!index || input.reader.header().channels[*index].type != PixelType::kUint)
      return fail(ErrorCode::kData, "{}: no channel spool.index: a tool dropped it; unusable",
                  input.name);
    return {};
  }
  for (const char* component : {"R", "G", "B"})
    SPOOL_TRY(want(input, "radiance", component, component, Scope::kSample));
  if (input.channel(kDepthChannel))
    SPOOL_TRY(want(input, "depth", "Z", kDepthChannel, Scope::kSample));
  return {};
}

float value_at(const DeepRow& row, const DeepHeader& header, size_t channel, size_t i) {
  switch (header.channels[channel].type) {
    case PixelType::kHalf:
      return format::half_to_float(load<uint16_t>(row.values[channel], 2 * i));
    case PixelType::kUint:
      return static_cast<float>(load<uint32_t>(row.values[channel], 4 * i));
    case PixelType::kFloat:
      break;
  }
  return load<float>(row.values[channel], 4 * i);
}

Result<void> check_row(const DeepInput& input, const DeepRow& row, int y) {
  for (size_t x = 0; x < row.counts.size(); ++x)
    if (row.counts[x] != input.spp)
      return fail(ErrorCode::kData,
                  "{}: pixel {},{} has {} samples and pixel 0,0 has {}: a pool needs the same in "
                  "every pixel",
                  input.name, x, y, row.counts[x], input.spp);
  const size_t values = row.counts.size() * input.spp;
  const auto place = [&](size_t i) {
    return fmt::format("sample {} of pixel {},{}", i % input.spp, i / input.spp, y);
  };
  if (input.told) {
    const auto index = *input.channel(kIndexChannel);
    for (size_t i = 0; i < values; ++i) {
      const auto number = load<uint32_t>(row.values[index], 4 * i);
      if (number != i % input.spp)
        return fail(ErrorCode::kData, "{}: {} has index {}: a tool reordered the samples",
                    input.name, place(i), number);
    }
    return {};
  }
  const DeepHeader& header = input.reader.header();
  const auto alpha = input.channel("A"), front = input.channel("Z"), back = input.channel("ZBack");
  for (size_t i = 0; i < values; ++i) {
    const bool composite =
        (alpha && value_at(row, header, *alpha, i) != 1.0f) ||
        (front && back && value_at(row, header, *back, i) > value_at(row, header, *front, i));
    if (composite)
      return fail(ErrorCode::kData,
                  "{}: {} is transparent or has thickness, as of compositing: samples are opaque "
                  "points, give those",
                  input.name, place(i));
  }
  return {};
}

// One row of a layer into the scratch file.
Result<void> put_row(const DeepInput& input, const Wanted& wanted, const DeepRow& row, uint64_t y,
                     FileHandle& scratch) {
  const uint64_t bytes = interchange::element_bytes(wanted.layer.array.type);
  const uint64_t channels = wanted.channels.size(), width = row.counts.size();
  const uint64_t pixel = input.spp * channels * bytes;
  std::vector<std::byte> out(width * pixel);
  for (uint64_t x = 0; x < width; ++x) {
    const uint64_t key = mix(kShuffleSeed, y * width + x);
    for (uint32_t s = 0; s < input.spp; ++s) {
      // A foreign tool may have sorted the samples, and a sorted prefix is biased.
      const uint64_t from = input.told ? s : permute_index(s, input.spp, key);
      for (uint64_t c = 0; c < channels; ++c)
        std::memcpy(&out[x * pixel + (s * channels + c) * bytes],
                    &row.values[wanted.channels[c]][(x * input.spp + from) * bytes], bytes);
    }
  }
  if (wanted.layer.scope == Scope::kSample)
    return scratch.write_at(wanted.layer.array.offset + y * out.size(), out);
  std::vector<std::byte> first(out.begin(), out.begin() + static_cast<ptrdiff_t>(pixel));
  if (y == 0) SPOOL_TRY(scratch.write_at(wanted.layer.array.offset, first));
  SPOOL_TRY(scratch.read_at(wanted.layer.array.offset, first));
  for (uint64_t x = 0; x < width; ++x)
    if (std::memcmp(first.data(), &out[x * pixel], pixel) != 0)
      return fail(ErrorCode::kData,
                  "{}: {} differs between pixel 0,0 and {},{}: it is one per pass", input.name,
                  wanted.layer.name, x, y);
  return {};
}

uint64_t lay_out(DeepInput& input, const FileHandle& scratch) {
  uint64_t end = 0;
  for (Wanted& wanted : input.wanted) {
    auto& array = wanted.layer.array;
    const bool pass = wanted.layer.scope == Scope::kPass;
    array.file = &scratch;
    array.offset = end;
    array.width = pass ? 1 : static_cast<uint32_t>(input.reader.header().width);
    array.height = pass ? 1 : static_cast<uint32_t>(input.reader.header().height);
    array.samples = input.spp;
    array.components = static_cast<uint32_t>(wanted.channels.size());
    end += array.bytes();
  }
  return end;
}

// All samples into the scratch file, where they end there.
Result<uint64_t> read_rows(DeepInput& input, const interchange::Expansion& expansion,
                           uint64_t source_bytes, FileHandle& scratch) {
  uint64_t end = 0;
  for (int y = 0; y < input.reader.header().height; ++y) {
    SPOOL_ASSIGN(const DeepRow row, input.reader.read_row(y));
    if (y == 0) {
      input.spp = row.counts[0];
      if (input.spp == 0 || input.spp > format::kMaxSpp)
        return fail(ErrorCode::kData, "{}: pixel 0,0 has {} samples: 1 to {} are possible",
                    input.name, input.spp, format::kMaxSpp);
      end = lay_out(input, scratch);
      SPOOL_TRY(expansion.check(input.name, end, source_bytes));
    }
    SPOOL_TRY(check_row(input, row, y));
    for (const Wanted& wanted : input.wanted)
      SPOOL_TRY(put_row(input, wanted, row, static_cast<uint64_t>(y), scratch));
  }
  return end;
}

// One part, which is a picture by its name, in the colours of Rec. 709.
Result<void> check_foreign(const std::filesystem::path& path) {
  SPOOL_ASSIGN(const ExrSource source, ExrSource::open(path));
  const std::vector<ExrPart>& parts = source.parts();
  std::vector<std::string> names;
  for (const ExrPart& part : parts)
    names.push_back(part.name);
  if (parts.size() > 1)
    return fail(ErrorCode::kData,
                "{}: has the parts {}: save the one that is meant in a file of its own",
                source.name(), listed(names));
  for (const ExrLayer& layer : layers_of(parts))
    if (layer.name == parts[0].name && layer.kind == LayerKind::kOther)
      return fail(ErrorCode::kData, "{}: is called {}, which is no radiance: give another part",
                  source.name(), layer.name);
  SPOOL_ASSIGN(const auto conversion, conversion_to_rec709(parts[0], source.name()));
  if (!conversion) return {};
  return fail(ErrorCode::kData, "{}: the colours are {}: convert to Rec. 709 first", source.name(),
              conversion->from);
}

Result<ImportReport> import_deep_exr(const std::filesystem::path& in,
                                     const std::filesystem::path& out,
                                     const DeepImportOptions& options) {
  SPOOL_TRY(format::refuse_existing_target(out, options.force));
  SPOOL_ASSIGN(DeepExrReader reader, DeepExrReader::open(in));
  const std::string name = in.string();
  SPOOL_ASSIGN(auto told, told_dump(reader.header().attributes, name));
  if (!told && !options.foreign_samples)
    return fail(ErrorCode::kUsage,
                "{}: not written by spool: give --set import.deep_samples=on if its samples are "
                "Monte Carlo "
                "samples",
                name);
  if (!told) SPOOL_TRY(check_foreign(in));
  DeepInput input{name, std::move(reader), std::move(told), {}, 0};
  const DeepHeader& header = input.reader.header();
  SPOOL_TRY(plan_channels(input));
  SPOOL_ASSIGN(const FileHandle file, FileHandle::open(in, format::OpenMode::kRead));
  SPOOL_ASSIGN(const uint64_t source_bytes, file.size());
  SPOOL_ASSIGN(FileHandle scratch, format::open_scratch_file(out));
  SPOOL_ASSIGN(uint64_t end, read_rows(input, options.expansion, source_bytes, scratch));
  DumpPlan plan;
  plan.width = static_cast<uint32_t>(header.width);
  plan.height = static_cast<uint32_t>(header.height);
  plan.spp = input.spp;
  plan.sample_order = input.told ? input.told->sample_order : format::SampleOrder::kExchangeable;
  for (Wanted& wanted : input.wanted)
    plan.layers.push_back(std::move(wanted.layer));
  if (input.told) plan.meta = input.told->meta;
  plan.record.format = "deep-exr";
  SPOOL_ASSIGN(interchange::ForeignFile identity, interchange::identify(file));
  plan.record.files.push_back(std::move(identity));
  if (input.told && input.told->has_pixel_layers())
    SPOOL_TRY(read_pixel_layers(input.told, source_of(header.attributes), pixel_file_of(in), end,
                                scratch, plan));
  for (ForeignLayer& layer : plan.layers)
    layer.array.file = &scratch;
  if (!input.told) {
    plan.shuffled = true;
    plan.record.converted = {"the samples of each pixel were shuffled"};
    for (const ExrChannel& channel : header.channels)
      if (std::string_view("RGBZ").find(channel.name) == std::string::npos)
        plan.record.dropped.push_back(printable_ascii(channel.name));
  }
  std::vector<std::string> notes = plan.record.converted;
  if (!plan.record.dropped.empty())
    notes.push_back("not taken over: " + listed(plan.record.dropped));
  SPOOL_ASSIGN(ImportReport report, write_dump(out, std::move(plan), options));
  report.notes.insert(report.notes.begin(), notes.begin(), notes.end());
  return report;
}

}  // namespace

interchange::ImportFormat deep_exr_format() {
  using O = DeepImportOptions;
  return interchange::import_format<O>(
      "deep-exr", "one deep sample per Monte Carlo sample",
      {switch_option<O>("deep_samples", &O::foreign_samples,
                        "take another tool's deep samples for Monte Carlo samples")},
      import_deep_exr);
}

interchange::ExportFormat deep_exr_target() {
  return interchange::export_format<interchange::ExportOptions>(
      "deep-exr", "a file with one deep sample per Monte Carlo sample", {}, export_deep_exr);
}

}  // namespace spool::exchange
