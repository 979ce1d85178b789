// Large file: writes 4096 x 4096 x 64 half-float samples as a sparse .spool, and times opening,
// random blocks (mapped and read) and the whole check. Prints one line of JSON.
#include <sys/resource.h>
#include <time.h>

#include <chrono>
#include <cstdio>
#include <cstdlib>

#include "formats/dump_check.h"
#include "tests/formats/large_dump.h"

namespace {

using namespace spool::format;

double milliseconds(auto&& work) {
  const auto begin = std::chrono::steady_clock::now();
  work();
  return std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - begin)
      .count();
}

// Of all threads: what the work costs where nothing else runs, times the threads that share it.
double cpu_milliseconds(auto&& work) {
  const auto now = [] {
    timespec time{};
    ::clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &time);
    return 1e3 * static_cast<double>(time.tv_sec) + 1e-6 * static_cast<double>(time.tv_nsec);
  };
  const double begin = now();
  work();
  return now() - begin;
}

double best_of(int times, auto&& work) {
  double best = 1e300;
  for (int i = 0; i < times; ++i)
    best = std::min(best, work());
  return best;
}

}  // namespace

int main(int count, char** arguments) {
  const auto side = static_cast<uint32_t>(count > 1 ? std::atoi(arguments[1]) : 4096);
  const std::filesystem::path path = count > 2 ? arguments[2] : "large.spool";
  const MadeDump dump = large_dump(side);
  const bool keep = std::filesystem::exists(path);  // measures it again
  const double write_ms = keep ? 0 : milliseconds([&] {
    if (auto made = write_large_dump(path, dump); !made) {
      std::fprintf(stderr, "%s\n", made.error().message.c_str());
      std::exit(3);
    }
  });
  double blocks_read = 0, blocks_mapped = 0;
  const auto open = [&] { static_cast<void>(SpoolReader::open(path)); };
  const double open_ms = best_of(15, [&] { return milliseconds(open); });
  const double open_cpu_ms = best_of(15, [&] { return cpu_milliseconds(open); });
  const auto reader = SpoolReader::open(path);
  if (!reader) return 4;
  constexpr uint32_t kBlocks = 1000;
  const auto place = [&](uint32_t i) {
    const uint64_t random = mix(i);
    return std::pair(static_cast<uint32_t>(random % reader->tiles()),
                     static_cast<uint32_t>((random >> 32) % reader->blocks()));
  };
  for (int pass = 0; pass < 2; ++pass) {  // the second is warm
    blocks_read = milliseconds([&] {
      for (uint32_t i = 0; i < kBlocks; ++i)
        if (!reader->read_block(0, place(i).first, place(i).second)) std::exit(4);
    });
    blocks_mapped = milliseconds([&] {
      for (uint32_t i = 0; i < kBlocks; ++i)
        if (!reader->map_block(0, place(i).first, place(i).second)) std::exit(4);
    });
  }
  bool whole = false;
  const double check_ms = milliseconds([&] { whole = check_dump(path)->complete; });
  struct rusage usage{};
  ::getrusage(RUSAGE_SELF, &usage);
  std::printf(
      "{\"side\": %u, \"file_bytes\": %llu, \"blocks\": %u, \"write_ms\": %.0f, \"open_ms\": %.1f, "
      "\"open_cpu_ms\": %.1f, "
      "\"block_read_ms\": %.3f, \"block_mapped_ms\": %.4f, \"check_ms\": %.0f, \"whole\": %s, "
      "\"peak_rss_mb\": %ld}\n",
      side, static_cast<unsigned long long>(std::filesystem::file_size(path)),
      reader->tiles() * reader->blocks(), write_ms, open_ms, open_cpu_ms, blocks_read / kBlocks,
      blocks_mapped / kBlocks, check_ms, whole ? "true" : "false", usage.ru_maxrss / 1024);
  return whole ? 0 : 4;
}
