#include "tools/bench/coverage/trials.h"

#include <cmath>
#include <cstdio>
#include <cstdlib>

#include "lib/core/check.h"
#include "lib/core/random.h"
#include "lib/experiment/sample_kurtosis.h"
#include "lib/filters/filters.h"
#include "lib/inference/shared_samples.h"
#include "lib/pool/load_recording.h"
#include "lib/sampling/samplers.h"
#include "lib/synthetic/scene_s.h"

namespace spool::bench {
namespace {

template <class Value>
Value or_exit(Result<Value> result) {
  if (result) return std::move(*result);
  std::fprintf(stderr, "bench_coverage: %s\n", result.error().message.c_str());
  std::exit(1);
}

std::shared_ptr<const RecordedSamples> shared(RecordedSamples recording) {
  return std::make_shared<const RecordedSamples>(std::move(recording));
}

}  // namespace

Trial run_trial(const World& world, const Protocol& protocol, std::uint64_t trial) {
  const auto recording = world.record(trial);
  ExperimentOptions options;
  options.seed = mix(2024, trial);
  options.order = protocol.order;
  options.metrics.perceptual = Perceptual::kNone;
  const ExperimentSources sources{
      [&](const std::string&) -> Result<std::shared_ptr<const RecordedSamples>> {
        return recording;
      },
      [](const MethodChoice& m) { return make_method(samplers(), m); },
      [](const MethodChoice& m) { return make_method(filters(), m); }};
  const double kurtosis = sample_kurtosis(*recording);
  std::vector<Cell> cells;
  for (const auto& [sampler, filter] : protocol.methods) {
    for (const double spp : protocol.spp) {
      for (int r = 0; r < protocol.replicates; ++r)
        cells.push_back({"world", {sampler, "", {}}, {filter, "", {}}, spp, r, 0});
    }
  }
  const std::vector<CellResult> results = run_experiment(cells, options, sources);
  Trial found(protocol.methods.size(), std::vector<Series>(protocol.spp.size()));
  std::size_t i = 0;
  for (std::vector<Series>& method : found) {
    for (std::size_t b = 0; b < protocol.spp.size(); ++b) {
      Series& series = method[b];
      std::map<int, long long> pieces;
      for (int r = 0; r < protocol.replicates; ++r, ++i) {
        const CellResult& result = results[i];
        if (result.error) {
          std::fprintf(stderr, "bench_coverage: %s\n", result.error->message.c_str());
          std::exit(1);
        }
        series.values.push_back(result.metrics[protocol.metric].value);
        for (const auto& [count, number] : result.counts)
          pieces[count] += number;
      }
      series.taken = {{pieces.begin(), pieces.end()},
                      static_cast<double>(recording->spp()),
                      rare_share(kurtosis, protocol.spp[b])};
      const Taking taking =
          protocol.order == ReplicateOrder::kDisjoint ? Taking::kOneAround : Taking::kOwnOrder;
      series.correlation =
          shared_by_replicates(series.taken, protocol.replicates, taking).correlation;
    }
  }
  return found;
}

World scene_s_world(int side, int samples, bool fireflies) {
  return {
      fireflies ? "scene S with fireflies" : "scene S", [=](std::uint64_t trial) {
        return shared(make_scene_s(side, side, samples, mix(7, trial), {.fireflies = fireflies}));
      }};
}

World heavy_world(int side, int samples) {
  return {"scene S times a tail of exponent 1.5", [=](std::uint64_t trial) {
            AnalyticScene scene = scene_s(side, side);
            const auto value = scene.value;
            // Pareto of mean 1: x = (1/3) u^(-2/3).
            scene.value = [value](const SampleDraw& draw) {
              return value(draw) * std::pow(1.0 - draw.q, -2.0 / 3.0) / 3.0;
            };
            const auto moments = scene.moments;
            scene.moments = [moments](int x, int y) {
              return Moments{moments(x, y).first, std::numeric_limits<double>::infinity()};
            };
            return shared(make_recording(scene, samples, mix(8, trial)));
          }};
}

World resampled_world(const std::string& path, int x0, int y0, int side, int samples) {
  const auto recorded = or_exit(load_recording(path));
  SPOOL_CHECK(x0 + side <= recorded->width() && y0 + side <= recorded->height());
  Reference truth;
  truth.mean = make_rgb(side, side);
  for (int y = 0; y < side; ++y) {
    for (int x = 0; x < side; ++x) {
      for (int s = 0; s < recorded->spp(); ++s) {
        const Rgb sample = recorded->radiance(x0 + x, y0 + y, s);
        for (std::size_t c = 0; c < 3; ++c)
          truth.mean[c](x, y) += static_cast<double>(sample[c]) / recorded->spp();
      }
    }
  }
  const std::string name = path.substr(path.find_last_of('/') + 1);
  return {name.substr(0, name.find('.')) + ", samples drawn from the recorded ones",
          [=](std::uint64_t trial) {
            const auto n = static_cast<std::size_t>(samples);
            const auto pixels = static_cast<std::size_t>(side) * static_cast<std::size_t>(side);
            std::vector<float> radiance(3 * pixels * n);
            for (std::size_t p = 0; p < pixels; ++p) {
              const int x = static_cast<int>(p) % side, y = static_cast<int>(p) / side;
              for (std::size_t s = 0; s < n; ++s) {
                const double u = unit_double(mix(9, trial, p, s));
                const Rgb drawn =
                    recorded->radiance(x0 + x, y0 + y, static_cast<int>(u * recorded->spp()));
                for (std::size_t c = 0; c < 3; ++c)
                  radiance[(c * pixels + p) * n + s] = drawn[c];
              }
            }
            RecordedSamples made = or_exit(RecordedSamples::from_memory(
                "resampled", side, side, samples, std::move(radiance)));
            made.set_exchangeable(true);
            made.set_reference(truth);
            return shared(std::move(made));
          }};
}

}  // namespace spool::bench
