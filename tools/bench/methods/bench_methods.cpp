// Time and memory of every sampler and filter of the lists, on one recording.
//
//   bench_methods RECORDING [--spp=8] [--threads=1,2] [--presets=all] [--benchmark_filter=REGEX
//   ...]
// A benchmark is named sampler/NAME[:PRESET]/tT or filter/NAME[:PRESET]/tT. Time: wall, and CPU of
// all threads. Default presets unless all are wanted:
// updating after every region, as `paper` does, is not meant for large images. heap_per_pixel:
// bytes on the heap at the worst moment of the call, with all that the method reads (for a filter
// the statistics that it needs and the attenuation) and without the mapped recording.
#include <charconv>
#include <cstdio>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include <benchmark/benchmark.h>

#include "lib/core/heap_policy.h"
#include "lib/core/parallel.h"
#include "lib/experiment/loop_filter.h"
#include "lib/filters/filters.h"
#include "lib/pool/load_recording.h"
#include "lib/sampling/samplers.h"
#include "lib/sampling/spending.h"
#include "tools/bench/methods/heap_peak.h"

namespace spool::bench {
namespace {

struct Subject {
  const SamplePool* pool = nullptr;
  long long budget = 0;
  std::optional<Selection> selection;  // of the multiscale sampler, made when a filter needs it
  long long heap_before_selection = 0;

  double pixels() const {
    return static_cast<double>(pool->recording().width()) * pool->recording().height();
  }
};

// Runs `call` as the body of a benchmark: Result of anything.
template <class Call>
void measure(benchmark::State& state, const Subject& subject, int threads, long long heap_before,
             const Call& call) {
  const ThreadLimit limit(threads);
  reset_heap_peak();
  for ([[maybe_unused]] auto _ : state) {
    auto result = call();
    if (!result) {
      state.SkipWithError(result.error().message.c_str());
      return;
    }
    benchmark::DoNotOptimize(result);
  }
  state.counters["heap_per_pixel"] =
      static_cast<double>(heap_peak() - heap_before) / subject.pixels();
  state.counters["pixels"] = subject.pixels();
  state.counters["threads"] = threads;
}

LoopFilter filter_in_loop() {
  const auto filter = make_method(filters(), {"directional", "", {}});
  return filter ? loop_filter(*filter) : LoopFilter{};
}

void measure_sampler(benchmark::State& state, Subject& subject, const ReadySampler& sample,
                     int threads) {
  subject.selection.reset();
  SamplingContext context;
  context.filter = filter_in_loop();
  measure(state, subject, threads, heap_bytes(),
          [&] { return sample(*subject.pool, subject.budget, context); });
}

// What `spool reconstruct` gives a filter that needs no more.
Selection means_alone(const Selection& selection) {
  const PieceStatistics& all = selection.statistics;
  return {.statistics = means_of(all.pieces_per_side, all.n, all.mean), .attenuation = {}};
}

void measure_filter(benchmark::State& state, Subject& subject, const ReadyFilter& filter,
                    int threads) {
  if (!subject.selection) {
    subject.heap_before_selection = heap_bytes();
    const auto sampler = make_method(samplers(), {"multiscale", "", {}});
    auto sampled = (*sampler)(*subject.pool, subject.budget, SamplingContext{});
    if (!sampled) {
      state.SkipWithError(sampled.error().message.c_str());
      return;
    }
    subject.selection = std::move(sampled->selection);
  }
  const auto& reference = subject.pool->recording().reference();
  FilterContext context{nullptr, reference ? &*reference : nullptr, {}};
  const bool whole = filter.needs.variance;
  context.variance = whole;
  const long long before = whole ? subject.heap_before_selection : heap_bytes();
  const Selection means = whole ? Selection{} : means_alone(*subject.selection);
  const Selection& given = whole ? *subject.selection : means;
  measure(state, subject, threads, before, [&] { return filter(given, *subject.pool, context); });
}

// One benchmark for each preset of each entry and each number of threads.
template <class Function, class Measure>
void register_entries(const MethodList<Function>& entries, Subject& subject,
                      const std::vector<int>& threads, bool all_presets, Measure measure_one) {
  for (const Method<Function>& entry : entries) {
    std::vector<std::string> presets = entry.presets;
    if (presets.empty()) presets.emplace_back();
    if (!all_presets) presets.resize(1);
    for (std::size_t i = 0; i < presets.size(); ++i) {
      const auto method = entry.make(presets[i], {});
      if (!method) continue;
      const std::string name = entries.kind + "/" + entry.name + (i == 0 ? "" : ":" + presets[i]);
      for (const int t : threads) {
        benchmark::RegisterBenchmark(
            (name + "/t" + std::to_string(t)).c_str(),
            [&subject, measure_one, method = *method, t](benchmark::State& state) {
              measure_one(state, subject, method, t);
            })
            ->Unit(benchmark::kMillisecond)
            ->MeasureProcessCPUTime()
            ->UseRealTime();
      }
    }
  }
}

std::vector<int> parse_numbers(std::string_view text) {
  std::vector<int> numbers;
  while (!text.empty()) {
    const std::size_t comma = std::min(text.find(','), text.size());
    int number = 0;
    std::from_chars(text.data(), text.data() + comma, number);
    numbers.push_back(number);
    text.remove_prefix(std::min(comma + 1, text.size()));
  }
  return numbers;
}

int run(int argc, char** argv) {
  std::string path;
  int spp = 8;
  bool all_presets = false;
  std::vector<int> threads = {1, 2};
  benchmark::Initialize(&argc, argv);
  for (int i = 1; i < argc; ++i) {
    const std::string_view argument = argv[i];
    if (argument.starts_with("--spp=")) {
      spp = parse_numbers(argument.substr(6)).at(0);
    } else if (argument.starts_with("--threads=")) {
      threads = parse_numbers(argument.substr(10));
    } else if (argument == "--presets=all") {
      all_presets = true;
    } else {
      path = argument;
    }
  }
  if (path.empty()) {
    std::fputs(
        "usage: bench_methods RECORDING [--spp=N] [--threads=1,2] [--presets=all] "
        "[--benchmark_...]\n",
        stderr);
    return 2;
  }
  const auto recording = load_recording(path);
  if (!recording) {
    std::fprintf(stderr, "%s\n", recording.error().message.c_str());
    return 1;
  }
  const auto pool = SamplePool::create(*recording, {});
  if (!pool) {
    std::fprintf(stderr, "%s\n", pool.error().message.c_str());
    return 1;
  }
  Subject subject{&*pool, sample_budget(spp, **recording), {}};
  register_entries(samplers(), subject, threads, all_presets, measure_sampler);
  register_entries(filters(), subject, threads, all_presets, measure_filter);
  benchmark::AddCustomContext("recording", path.substr(path.find_last_of('/') + 1));
  benchmark::AddCustomContext("spp", std::to_string(spp));
  benchmark::RunSpecifiedBenchmarks();
  return 0;
}

}  // namespace
}  // namespace spool::bench

int main(int argc, char** argv) {
  spool::keep_freed_memory();
  return spool::bench::run(argc, argv);
}
