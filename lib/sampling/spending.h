// How every sampler begins and ends: what it has spent, what is left, and the log of both.
#pragma once

#include <string_view>

#include "lib/core/image.h"
#include "lib/sampling/sampler.h"

namespace spool {

// A budget being spent on a pool. Code that takes samples keeps `left` right.
struct Spending {
  PieceStatistics statistics;  // of everything taken so far
  long long left = 0;          // of the budget, as far as the pool reaches
  SamplingLog log;
};

enum class ChannelRange { kNone, kKept };  // least and largest sample of each channel

// Takes the `first` samples of every piece [y][x], before any decision, and exposes their luminance
// to mean 1.
Spending begin_spending(const SamplePool& pool, long long budget, const CountImage& first,
                        ChannelRange range = ChannelRange::kNone);

// Exposes the statistics' luminance to mean 1, frozen from then on.
void expose(PieceStatistics& statistics, const SamplePool& pool, GuardCounts& guards);

// Takes `extra` samples of every piece; how many they were.
long long spend(Spending& spending, const SamplePool& pool, const CountImage& extra);

// Reports to the context how far a sampler is; an error when the caller stops it.
Result<void> report_progress(const SamplingContext& context, std::string_view sampler,
                             long long spent, long long budget);

// Closes a run: counts what was spent and which pieces ran out.
SamplingResult end_spending(Spending spending, const SamplePool& pool);

// Budget in samples for a number of samples per pixel, which need not be whole.
long long sample_budget(double samples_per_pixel, const RecordedSamples& recording);

long long count_samples(const CountImage& n);
// Pieces of which every offered sample was taken.
long long count_saturated(const SamplePool& pool, const CountImage& n);

// What every log says at its end: spent samples, saturated pieces, and the guards that follow.
void finish_log(SamplingLog& log, const SamplePool& pool, const CountImage& n);

}  // namespace spool
