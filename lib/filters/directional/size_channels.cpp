#include "lib/filters/directional/size_channels.h"

#include <utility>

#include "lib/core/parallel.h"

namespace spool {

std::vector<SizeChannel> size_channels(const PieceStatistics& statistics, const SamplePool& pool,
                                       double exposure, const VarianceOptions& variance) {
  AnalysisSignal signal = statistics.signal;
  signal.exposure = exposure;
  std::vector<SizeChannel> channels;
  for (std::size_t c = 0; c < 3; ++c) {
    ScalarStatistics taken(statistics.width(), statistics.height());
    parallel_rows(0, statistics.height(), [&](int y) {
      for (int x = 0; x < statistics.width(); ++x) {
        const std::size_t piece = statistics.n.index(x, y);
        for (int i = 0; i < statistics.n[piece]; ++i) {
          const float value = pool.sample(x, y, i)[c];
          taken.add(piece, i + 1, signal.value({value, value, value}));
        }
      }
    });
    GuardCounts counted_with_the_image;
    const auto filled = [&](const Plane& plane) {
      return fill_empty_pieces(plane, statistics.n, statistics.pieces_per_side,
                               counted_with_the_image);
    };
    SizeChannel channel;
    channel.variance = filled(
        variance_of_mean(statistics.n, taken.mean, taken.m2, variance, counted_with_the_image));
    channel.mean = filled(taken.mean);
    channel.minimum = std::move(taken.minimum);
    channel.maximum = std::move(taken.maximum);
    channels.push_back(std::move(channel));
  }
  return channels;
}

PieceStatistics with_analysis_channel(PieceStatistics statistics, const SamplePool& pool,
                                      SizeChannels channels) {
  AnalysisSignal signal = statistics.signal;
  if (channels == SizeChannels::kLuminance) signal.channel = AnalysisChannel::kLuminance;
  if (channels == SizeChannels::kMaxRgb) signal.channel = AnalysisChannel::kMaxRgb;
  set_signal(statistics, pool, signal);
  return statistics;
}

}  // namespace spool
