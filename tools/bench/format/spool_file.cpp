#include "tools/bench/format/spool_file.h"

#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <ctime>

#include "formats/dump_geometry.h"
#include "formats/spool_reader.h"
#include "formats/spool_writer.h"

namespace spool::bench {
namespace {

using namespace format;

template <class T>
T must(Result<T> result) {
  if (result) return std::move(*result);
  std::fprintf(stderr, "%s\n", result.error().message.c_str());
  std::exit(static_cast<int>(result.error().code));
}

void must(const Result<void>& result) {
  if (result) return;
  std::fprintf(stderr, "%s\n", result.error().message.c_str());
  std::exit(static_cast<int>(result.error().code));
}

// Copies between a block, [c][y][x][s] of one tile, and the channels, [y][x][s] of the image.
template <class Samples, class Copy>
void for_each_run(Samples& samples, const DumpGeometry& geometry, uint16_t group, uint32_t tile,
                  uint32_t block, const Copy& copy) {
  const PixelRect rect = geometry.tile_rect(tile);
  const size_t begin = geometry.block_begin(group, block);
  const size_t count = geometry.block_count(group, block);
  size_t at = 0;
  for (auto& channel : samples.channels) {
    if (channel.about.group != group) continue;
    const size_t size = channel.value_bytes();
    for (uint32_t y = rect.y0; y < rect.y1; ++y)
      for (uint32_t x = rect.x0; x < rect.x1; ++x, at += count * size)
        copy(at, channel, ((size_t{y} * samples.width + x) * samples.spp + begin) * size,
             count * size);
  }
}

DumpHeader header_of(const RecordedSamples& samples) {
  DumpHeader header;
  header.width = samples.width;
  header.height = samples.height;
  header.spp = samples.spp;
  header.tile_size = 64;
  header.block_spp = 16;
  header.sample_order = SampleOrder::kExchangeable;
  for (const SampleChannel& channel : samples.channels)
    header.channels.push_back(channel.about);
  return header;
}

template <class Visit>
void for_each_block(const DumpGeometry& geometry, const Visit& visit) {
  const auto groups = static_cast<uint16_t>(geometry.groups().size());  // at most 16
  for (uint16_t group = 0; group < groups; ++group)
    for (uint32_t tile = 0; tile < geometry.groups()[group].tiles; ++tile)
      for (uint32_t block = 0; block < geometry.groups()[group].blocks; ++block)
        visit(group, tile, block);
}

void read_blocks(const SpoolReader& reader, RecordedSamples& into) {
  const DumpGeometry geometry(reader.header());
  for_each_block(geometry, [&](uint16_t group, uint32_t tile, uint32_t block) {
    if (geometry.groups()[group].scope != Scope::kSample) return;
    const auto bytes = must(reader.read_block(group, tile, block));
    for_each_run(into, geometry, group, tile, block,
                 [&](size_t at, SampleChannel& channel, size_t to, size_t count) {
                   std::memcpy(channel.values.data() + to, bytes.data() + at, count);
                 });
  });
}

}  // namespace

double cpu_seconds() {
  timespec now{};
  ::clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &now);
  return static_cast<double>(now.tv_sec) + 1e-9 * static_cast<double>(now.tv_nsec);
}

RecordedSamples stacked_recordings(const std::vector<std::filesystem::path>& paths) {
  RecordedSamples all;
  for (const auto& path : paths) {
    const SpoolReader reader = must(SpoolReader::open(path));
    const DumpHeader& header = reader.header();
    RecordedSamples one{header.width, header.height, header.spp, {}};
    for (const ChannelInfo& channel : header.channels) {
      if (channel.scope != Scope::kSample) continue;
      SampleChannel& made = one.channels.emplace_back(SampleChannel{channel, {}});
      made.values.resize(one.samples() * made.value_bytes());
    }
    read_blocks(reader, one);
    if (all.channels.empty()) {
      all = std::move(one);
      continue;
    }
    if (one.width != all.width || one.spp != all.spp ||
        one.channels.size() != all.channels.size()) {
      std::fprintf(stderr, "%s: has another width or other channels\n", path.c_str());
      std::exit(2);
    }
    all.height += one.height;
    for (size_t c = 0; c < all.channels.size(); ++c) {
      auto& values = all.channels[c].values;
      values.insert(values.end(), one.channels[c].values.begin(), one.channels[c].values.end());
    }
  }
  return all;
}

void write_spool(const std::filesystem::path& path, const RecordedSamples& samples, bool compress) {
  WriterOptions options;
  options.compress = compress;
  options.force = true;
  SpoolWriter writer = must(SpoolWriter::create(path, header_of(samples), options));
  const DumpGeometry geometry(writer.header());
  std::vector<std::byte> bytes;
  for_each_block(geometry, [&](uint16_t group, uint32_t tile, uint32_t block) {
    bytes.resize(geometry.raw_bytes(group, tile, block));
    for_each_run(samples, geometry, group, tile, block,
                 [&](size_t at, const SampleChannel& channel, size_t from, size_t count) {
                   std::memcpy(bytes.data() + at, channel.values.data() + from, count);
                 });
    must(writer.write_block(group, tile, geometry.block_begin(group, block),
                            geometry.block_count(group, block), bytes));
  });
  must(writer.finish());
}

void read_spool(const std::filesystem::path& path, RecordedSamples& into) {
  read_blocks(must(SpoolReader::open(path)), into);
}

uint64_t sum_of_words(const std::byte* data, size_t bytes) {
  uint64_t sums[4] = {0, 0, 0, 0};
  size_t i = 0;
  for (; i + 32 <= bytes; i += 32)
    for (size_t k = 0; k < 4; ++k) {
      uint64_t word = 0;
      std::memcpy(&word, data + i + 8 * k, 8);
      sums[k] += word;
    }
  for (; i + 8 <= bytes; i += 8) {
    uint64_t word = 0;
    std::memcpy(&word, data + i, 8);
    sums[0] += word;
  }
  return sums[0] + sums[1] + sums[2] + sums[3];
}

MappedSums sum_mapped(const std::filesystem::path& path) {
  const SpoolReader reader = must(SpoolReader::open(path));
  MappedSums sums;
  for (int pass = 0; pass < 2; ++pass) {
    const double begin = cpu_seconds();
    uint64_t sum = 0;
    for (uint32_t tile = 0; tile < reader.tiles(); ++tile)
      for (uint32_t block = 0; block < reader.blocks(); ++block) {
        const auto bytes = must(reader.map_block(0, tile, block));
        sum += sum_of_words(bytes.data(), bytes.size());
      }
    (pass == 0 ? sums.first : sums.second) = sum;
    (pass == 0 ? sums.first_seconds : sums.second_seconds) = cpu_seconds() - begin;
  }
  return sums;
}

}  // namespace spool::bench
