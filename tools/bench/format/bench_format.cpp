// The cost of keeping samples: .spool against memcpy of the same bytes and against OpenEXR.
//
//   bench_format TURNS FOLDER RECORDING...
// CPU seconds of one thread, the least of the turns; the kinds take turns. Files lie in FOLDER,
// which should be in memory: the disk is not what is measured. Prints one JSON array.
#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <functional>

#include <fmt/core.h>

#include <Imath/half.h>

#include "lib/core/heap_policy.h"
#include "tools/bench/format/exr_files.h"
#include "tools/bench/format/spool_file.h"

namespace {

using namespace spool::bench;
using spool::format::DataType;

RecordedSamples radiance_of(const RecordedSamples& all) {
  RecordedSamples radiance{all.width, all.height, all.spp, {}};
  for (const SampleChannel& channel : all.channels)
    if (channel.about.group == 0) radiance.channels.push_back(channel);
  return radiance;
}

// Values above 65504 become that here: the comparison is of sizes and times, not of pictures.
RecordedSamples as_half(RecordedSamples samples) {
  for (SampleChannel& channel : samples.channels) {
    if (channel.about.type != DataType::kFloat32) continue;
    std::vector<std::byte> halves(channel.values.size() / 2);
    for (size_t i = 0; i < halves.size() / 2; ++i) {
      float value = 0;
      std::memcpy(&value, channel.values.data() + 4 * i, 4);
      const half rounded(std::clamp(value, -65504.0F, 65504.0F));
      std::memcpy(halves.data() + 2 * i, &rounded, 2);
    }
    channel.about.type = DataType::kFloat16;
    channel.values = std::move(halves);
  }
  return samples;
}

uint64_t bytes_on_disk(const std::filesystem::path& path) {
  if (!std::filesystem::is_directory(path)) return std::filesystem::file_size(path);
  uint64_t bytes = 0;
  for (const auto& entry : std::filesystem::directory_iterator(path))
    bytes += entry.file_size();
  return bytes;
}

struct Kind {
  const char* name;
  std::filesystem::path path;
  std::function<void(RecordedSamples&)> write, read;
  double write_seconds = 1e300, read_seconds = 1e300;
};

void keep_least(double& least, const std::function<void()>& work) {
  const double begin = cpu_seconds();
  work();
  least = std::min(least, cpu_seconds() - begin);
}

// `back` is what a copy in memory goes to.
std::vector<Kind> kinds_in(const std::filesystem::path& folder, RecordedSamples& back) {
  std::vector<Kind> kinds = {{"memcpy",
                              {},
                              [&](RecordedSamples& from) {
                                for (size_t c = 0; c < from.channels.size(); ++c)
                                  std::memcpy(back.channels[c].values.data(),
                                              from.channels[c].values.data(),
                                              from.channels[c].values.size());
                              },
                              nullptr}};
  const auto add = [&](const char* kind, const char* file, auto write, auto read) {
    const auto path = folder / file;
    kinds.push_back({kind, path, [=](RecordedSamples& from) { write(path, from); },
                     [=](RecordedSamples& into) { read(path, into); }});
  };
  add(
      "spool raw", "raw.spool", [](const auto& p, auto& s) { write_spool(p, s, false); },
      read_spool);
  add(
      "spool compressed", "zstd.spool", [](const auto& p, auto& s) { write_spool(p, s, true); },
      read_spool);
  add("deep EXR zips", "deep.exr", write_deep_exr, read_deep_exr);
  add(
      "flat EXR none", "none", [](const auto& p, auto& s) { write_flat_exr(p, s, false); },
      read_flat_exr);
  add(
      "flat EXR zip", "zip", [](const auto& p, auto& s) { write_flat_exr(p, s, true); },
      read_flat_exr);
  return kinds;
}

// Writes and reads `samples` once in every kind.
void take_turn(std::vector<Kind>& kinds, RecordedSamples& samples, RecordedSamples& back) {
  for (Kind& kind : kinds) {
    keep_least(kind.write_seconds, [&] { kind.write(samples); });
    if (!kind.read) continue;
    for (SampleChannel& channel : back.channels)
      std::ranges::fill(channel.values, std::byte{0xFF});
    keep_least(kind.read_seconds, [&] { kind.read(back); });
    for (size_t c = 0; c < back.channels.size(); ++c)
      if (back.channels[c].values != samples.channels[c].values) {
        std::fprintf(stderr, "%s: other samples came back\n", kind.name);
        std::exit(4);
      }
  }
}

std::string compare(const char* name, RecordedSamples samples, const std::filesystem::path& folder,
                    int turns) {
  RecordedSamples back = samples;
  std::vector<Kind> kinds = kinds_in(folder, back);
  double mapped = 1e300, mapped_first = 1e300, plain = 1e300;
  for (int turn = 0; turn < turns; ++turn) {
    take_turn(kinds, samples, back);
    const MappedSums sums = sum_mapped(folder / "raw.spool");
    mapped_first = std::min(mapped_first, sums.first_seconds);
    mapped = std::min(mapped, sums.second_seconds);
    uint64_t sum = 0;
    keep_least(plain, [&] {
      for (const SampleChannel& channel : samples.channels)
        if (channel.about.group == 0)
          sum += sum_of_words(channel.values.data(), channel.values.size());
    });
    if (sum != sums.first || sum != sums.second) std::exit(4);
  }
  std::string text = fmt::format(
      "{{\"samples\": \"{}\", \"count\": {}, \"bytes\": {}, \"mapped\": {}, \"mapped_first\": {}, "
      "\"plain_sum\": {}, \"kinds\": {{",
      name, samples.samples(), samples.bytes(), mapped, mapped_first, plain);
  for (const Kind& kind : kinds) {
    text += fmt::format("{}\"{}\": {{\"write\": {}, \"read\": {}, \"bytes\": {}}}",
                        &kind == kinds.data() ? "" : ", ", kind.name, kind.write_seconds,
                        kind.read ? kind.read_seconds : kind.write_seconds,
                        kind.read ? bytes_on_disk(kind.path) : samples.bytes());
  }
  return text + "}}";
}

}  // namespace

int main(int count, char** arguments) {
  if (count < 4) {
    std::fprintf(stderr, "usage: bench_format TURNS FOLDER RECORDING...\n");
    return 2;
  }
  spool::keep_freed_memory();  // as spool itself does
  const int turns = std::atoi(arguments[1]);
  const std::filesystem::path folder = arguments[2];
  const RecordedSamples all = stacked_recordings({arguments + 3, arguments + count});
  const RecordedSamples radiance = radiance_of(all);
  const auto line = [&](const char* name, const RecordedSamples& samples) {
    return compare(name, samples, folder, turns);
  };
  std::printf("[%s,\n %s,\n %s,\n %s]\n", line("radiance, as recorded (f32)", radiance).c_str(),
              line("radiance, half", as_half(radiance)).c_str(),
              line("radiance f32 + albedo, normal, depth f16, as recorded", all).c_str(),
              line("radiance, albedo, normal, depth, half", as_half(all)).c_str());
  return 0;
}
