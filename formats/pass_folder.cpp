#include "formats/pass_folder.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstring>
#include <functional>
#include <set>
#include <span>
#include <utility>

#include "formats/checked_math.h"
#include "formats/pass_file.h"
#include "formats/pass_recording.h"
#include "formats/sample_watch.h"
#include "formats/spool_writer.h"

namespace spool::format {

namespace {

constexpr float kLargestHalf = 65504.0F;
constexpr uint64_t kFreeBytes = uint64_t{32} << 20;  // as of foreign files

// Takes a block, as SpoolWriter::write_block.
using Sink =
    std::function<Result<void>(uint16_t, uint32_t, uint32_t, uint32_t, std::span<const std::byte>)>;

Result<uint16_t> to_half(float value, const PassManifest& manifest, const PassEntry& entry,
                         uint32_t plane, uint32_t x, uint32_t y) {
  if (std::isfinite(value) && std::abs(value) > kLargestHalf) {
    return fail(ErrorCode::kData,
                "{}: {} is {} (pixel {}, {}), which f16 cannot hold: pack with {}",
                entry.file.string(), manifest.channels[plane].name, value, x, y,
                plane < 3 ? "radiance as f32" : "features as f32 (--full-features)");
  }
  return std::bit_cast<uint16_t>(static_cast<_Float16>(value));
}

// One sample of one plane into the blocks of its group, [channel][y][x][sample].
Result<void> scatter(const PassManifest& manifest, const PassEntry& entry, uint32_t plane,
                     std::span<const float> rows, uint32_t image_width, DataType type,
                     size_t channel, size_t sample, size_t count, std::span<const Tile> tiles,
                     std::vector<std::vector<std::byte>>& blocks, uint64_t& not_finite) {
  for (size_t t = 0; t < tiles.size(); ++t) {
    const Tile& tile = tiles[t];
    std::byte* block = blocks[t].data();
    for (uint32_t y = 0; y < tile.height; ++y) {
      for (uint32_t x = 0; x < tile.width; ++x) {
        const size_t at = ((channel * tile.height + y) * tile.width + x) * count + sample;
        const float value = rows[size_t{y} * image_width + tile.x0 + x];
        not_finite += !std::isfinite(value);
        if (type == DataType::kFloat16) {
          SPOOL_ASSIGN(const uint16_t half,
                       to_half(value, manifest, entry, plane, tile.x0 + x, tile.y0 + y));
          std::memcpy(block + 2 * at, &half, 2);
        } else {
          std::memcpy(block + 4 * at, &value, 4);
        }
      }
    }
  }
  return {};
}

// Samples [begin, begin + count) of one row of tiles, all sample groups.
Result<void> write_band(const PassManifest& manifest, const DumpPlan& plan,
                        std::span<const Tile> tiles, uint32_t begin, uint32_t count,
                        SampleWatch& watch, uint64_t& not_finite, const Sink& sink) {
  const uint32_t y0 = tiles.front().y0;
  const uint32_t y1 = y0 + tiles.front().height;
  const auto planes = static_cast<uint32_t>(manifest.channels.size());
  std::vector<float> rows(size_t{manifest.width} * (y1 - y0));
  for (const SampleGroup& group : plan.groups) {
    std::vector<std::vector<std::byte>> blocks;
    for (const Tile& tile : tiles) {
      blocks.emplace_back(size_t{tile.width} * tile.height * count * group.bytes_per_sample());
    }
    for (uint32_t s = 0; s < count; ++s) {
      const PassEntry& entry = manifest.passes[begin + s];
      for (size_t c = 0; c < group.planes.size(); ++c) {
        SPOOL_TRY(read_pass_rows(manifest, entry, planes, group.planes[c], y0, y1, rows));
        SPOOL_TRY(scatter(manifest, entry, group.planes[c], rows, manifest.width, group.type, c, s,
                          count, tiles, blocks, not_finite));
      }
    }
    for (size_t t = 0; t < tiles.size(); ++t) {
      const Tile& tile = tiles[t];
      if (group.group == 0)
        watch.add({tile.x0, tile.y0, tile.x0 + tile.width, tile.y0 + tile.height}, begin, count,
                  group.type, blocks[t]);
      SPOOL_TRY(sink(group.group, tiles[t].number, begin, count, blocks[t]));
    }
  }
  return {};
}

template <class Value, class Take>
Result<void> write_pass_group(const PassManifest& manifest, const DumpHeader& header,
                              uint16_t group, size_t channels, Take take, const Sink& sink) {
  for (uint32_t begin = 0; begin < header.spp; begin += header.block_spp) {
    const uint32_t count = std::min(header.block_spp, header.spp - begin);
    std::vector<Value> values;
    for (size_t c = 0; c < channels; ++c) {
      for (uint32_t s = 0; s < count; ++s)
        values.push_back(take(manifest.passes[begin + s], c));
    }
    SPOOL_TRY(sink(group, 0, begin, count, std::as_bytes(std::span(values))));
  }
  return {};
}

// Mean of the batches and variance of that mean, pixel by pixel [Welford62], in the order of the
// batches, double; rounded to float32 at the end.
Result<void> write_reference_band(const PassManifest& manifest, const DumpPlan& plan,
                                  std::span<const Tile> tiles, uint64_t& not_finite,
                                  const Sink& sink) {
  const uint32_t y0 = tiles.front().y0;
  const uint32_t y1 = y0 + tiles.front().height;
  const size_t plane = size_t{manifest.width} * (y1 - y0);
  std::vector<double> mean(3 * plane, 0.0);
  std::vector<double> squares(3 * plane, 0.0);
  std::vector<float> rows(plane);
  double count = 0.0;
  for (const PassEntry& batch : manifest.batches) {
    if (manifest.is_folded()) break;
    count += 1.0;
    for (uint32_t c = 0; c < 3; ++c) {
      SPOOL_TRY(read_pass_rows(manifest, batch, 3, c, y0, y1, rows));
      for (size_t i = 0; i < plane; ++i) {
        const double delta = rows[i] - mean[c * plane + i];
        mean[c * plane + i] += delta / count;
        squares[c * plane + i] += delta * (rows[i] - mean[c * plane + i]);
      }
    }
  }
  for (uint32_t c = 0; c < 6 && manifest.is_folded(); ++c) {
    SPOOL_TRY(read_pass_rows(manifest, manifest.batches[0], 6, c, y0, y1, rows));
    std::copy(rows.begin(), rows.end(),
              (c < 3 ? mean : squares).begin() + static_cast<std::ptrdiff_t>((c % 3) * plane));
  }
  // That of the mean, from the sum of squares or as it is.
  const double divisor = manifest.is_folded() ? 1.0 : (count - 1.0);
  const double again = manifest.is_folded() ? 1.0 : count;
  const bool variance = manifest.is_folded() || manifest.batches.size() > 1;
  for (const Tile& tile : tiles) {
    std::vector<float> values;
    values.reserve(size_t{6} * tile.width * tile.height);
    for (size_t c = 0; c < (variance ? 6U : 3U); ++c) {
      for (uint32_t y = 0; y < tile.height; ++y) {
        for (uint32_t x = 0; x < tile.width; ++x) {
          const size_t at = (c % 3) * plane + size_t{y} * manifest.width + tile.x0 + x;
          const double value = c < 3 ? mean[at] : squares[at] / divisor / again;
          values.push_back(static_cast<float>(value));
          not_finite += c < 3 && !std::isfinite(value);
        }
      }
    }
    SPOOL_TRY(sink(plan.reference, tile.number, 0, 1, std::as_bytes(std::span(values))));
  }
  return {};
}

// A link goes with what it stands for, except where other recordings share it.
void remove_files(std::span<const PassEntry> entries, bool shared) {
  std::error_code code;
  for (const PassEntry& entry : entries) {
    const std::filesystem::path real = std::filesystem::canonical(entry.file, code);
    if (!code && !shared) std::filesystem::remove(real, code);
    std::filesystem::remove(entry.file, code);
  }
}

// What contradicts the order that the recording claims, where it claims less; kData where it does
// not.
Result<std::string> judge(const SampleWatch& watch, const PassManifest& manifest,
                          SampleOrder claim) {
  std::string objection = watch.objection();
  if (objection.empty() || claim != SampleOrder::kExchangeable) return objection;
  return fail(ErrorCode::kData,
              "{}: {}, so the samples of a pixel are not exchangeable: record them again",
              manifest.folder.string(), objection);
}

// What the files hold against what they are: packed zeros are short.
Result<void> check_expansion(const PassManifest& manifest, const PackOptions& options) {
  std::set<std::filesystem::path> files;
  uint64_t stored = 0;
  uint64_t planes = 0;
  std::error_code code;
  for (const auto& [list, channels] :
       {std::pair(&manifest.passes, static_cast<uint32_t>(manifest.channels.size())),
        std::pair(&manifest.batches, manifest.batch_channels())}) {
    for (const PassEntry& entry : *list) {
      planes += channels;
      if (files.insert(entry.file).second) stored += std::filesystem::file_size(entry.file, code);
    }
  }
  const uint64_t plane = uint64_t{4} * manifest.width * manifest.height;
  const uint64_t wanted = checked_multiply(plane, planes).value_or(UINT64_MAX);
  const uint64_t allowed = checked_multiply(options.max_expansion, stored).value_or(UINT64_MAX);
  if (wanted <= std::max(allowed, kFreeBytes)) return {};
  return fail(ErrorCode::kData,
              "{}: {} bytes would become {}, more than {} times as many: if that is right, give "
              "--max-expansion {}",
              manifest.folder.string(), stored, wanted, options.max_expansion,
              wanted / std::max<uint64_t>(stored, 1) + 1);
}

// All blocks into `sink`; after those of some passes, `taken` hears which. Returns remarks on the
// samples, or nothing.
Result<std::string> write_blocks(const PassManifest& manifest, const DumpPlan& plan,
                                 const Sink& sink,
                                 const std::function<void(std::span<const PassEntry>)>& taken) {
  const DumpHeader& header = plan.header;
  if (plan.film != 0) {
    SPOOL_TRY(write_pass_group<float>(
        manifest, header, plan.film, 2,
        [](const PassEntry& pass, size_t c) { return c == 0 ? pass.film_x : pass.film_y; }, sink));
  }
  SPOOL_TRY(write_pass_group<uint32_t>(
      manifest, header, plan.seed, 1, [](const PassEntry& pass, size_t) { return pass.seed; },
      sink));
  uint64_t not_finite = 0;
  SampleWatch watch(header.width, header.height, header.spp, plan.film != 0);
  const uint32_t bands = (header.height + header.tile_size - 1) / header.tile_size;
  for (uint32_t band = 0; band < bands && plan.reference != 0; ++band) {
    SPOOL_TRY(write_reference_band(manifest, plan, tiles_of_band(header, band), not_finite, sink));
  }
  // Block by block of samples, so that passes can go when they are in the file.
  for (uint32_t begin = 0; begin < header.spp; begin += header.block_spp) {
    const uint32_t count = std::min(header.block_spp, header.spp - begin);
    for (uint32_t band = 0; band < bands; ++band) {
      SPOOL_TRY(write_band(manifest, plan, tiles_of_band(header, band), begin, count, watch,
                           not_finite, sink));
    }
    taken(std::span(manifest.passes).subspan(begin, count));
  }
  SPOOL_ASSIGN(std::string remark, judge(watch, manifest, header.sample_order));
  if (not_finite > 0)
    remark += fmt::format("{}values that are not finite, stored as they are: {}",
                          remark.empty() ? "" : "; ", not_finite);
  return remark;
}

// Everything that can be wrong with the passes, before the first of them goes. Nothing is written.
Result<void> check_all(const PassManifest& manifest, const DumpPlan& plan) {
  const auto nowhere = [](uint16_t, uint32_t, uint32_t, uint32_t, std::span<const std::byte>) {
    return Result<void>();
  };
  SPOOL_TRY(write_blocks(manifest, plan, nowhere, [](std::span<const PassEntry>) {}));
  return {};
}

// `removed`: passes have gone, and only the unfinished file holds them.
Result<std::string> write_dump(const PassRecording& recording, const DumpPlan& plan,
                               bool remove_passes, bool& removed, SpoolWriter& writer) {
  const PassManifest& manifest = recording.manifest;
  SPOOL_TRY(writer.write_meta(recording_meta(recording)));
  const auto sink = [&](uint16_t group, uint32_t tile, uint32_t begin, uint32_t count,
                        std::span<const std::byte> payload) {
    return writer.write_block(group, tile, begin, count, payload);
  };
  const auto taken = [&](std::span<const PassEntry> passes) {
    if (!remove_passes) return;
    if (!removed) remove_files(manifest.batches, true);
    removed = true;
    remove_files(passes, false);
  };
  SPOOL_ASSIGN(std::string remark, write_blocks(manifest, plan, sink, taken));
  SPOOL_TRY(writer.finish());
  return remark;
}

PackReport report_of(const PassRecording& recording, const DumpHeader& header,
                     const std::filesystem::path& out) {
  PackReport report{header.width, header.height, header.spp, 0, 0, 0.0, {}, 0, {}};
  report.batches = static_cast<uint32_t>(recording.manifest.batch_seeds().size());
  report.reference_spp = report.batches * recording.manifest.batch_samples();
  report.cost_per_sample = cost_per_sample(recording);
  for (const ChannelInfo& channel : header.channels) {
    const std::string layer = channel.name.substr(0, channel.name.find('.'));
    if (report.layers.empty() || report.layers.back() != layer) report.layers.push_back(layer);
  }
  std::error_code code;
  report.bytes = std::filesystem::file_size(out, code);
  return report;
}

// After an error: an unfinished file stays where it alone holds passes, which is said.
tl::unexpected<Error> keep_or_drop(Error error, const std::filesystem::path& out,
                                   bool remove_passes, bool removed) {
  std::filesystem::path partial = out;
  partial += ".partial";
  std::error_code ignored;
  if (!remove_passes) return tl::unexpected(std::move(error));
  if (removed)
    return fail(error.code, "{}; {} keeps the passes that are gone: spool recover", error.message,
                partial.string());
  std::filesystem::remove(partial, ignored);
  return tl::unexpected(std::move(error));
}

}  // namespace

Result<PackReport> pack_passes(const std::vector<std::filesystem::path>& folders,
                               const std::filesystem::path& out, const PackOptions& options) {
  SPOOL_ASSIGN(const PassRecording recording, read_pass_recording(folders));
  SPOOL_TRY(check_expansion(recording.manifest, options));
  SPOOL_ASSIGN(const DumpPlan plan, plan_dump(recording.manifest, options));
  WriterOptions writer_options;
  writer_options.compress = options.compress;
  writer_options.force = options.force;
  writer_options.uuid = options.uuid;
  // A recording of half the samples is no use where the passes are still at hand.
  writer_options.discard_unfinished = !options.remove_passes;
  if (options.remove_passes) SPOOL_TRY(check_all(recording.manifest, plan));
  bool removed = false;
  Result<std::string> remark;
  {
    SPOOL_ASSIGN(SpoolWriter writer, SpoolWriter::create(out, plan.header, writer_options));
    remark = write_dump(recording, plan, options.remove_passes, removed, writer);
  }
  if (!remark) return keep_or_drop(std::move(remark).error(), out, options.remove_passes, removed);
  PackReport report = report_of(recording, plan.header, out);
  report.remark = std::move(*remark);
  return report;
}

}  // namespace spool::format
