// What one method gave on one scene at one budget: the values of every quantity over its
// replicates, those of all recordings of the scene together.
#pragma once

#include <functional>
#include <map>
#include <set>
#include <string>
#include <vector>

#include "lib/core/error.h"
#include "lib/experiment/plan.h"
#include "lib/experiment/plan_cells.h"
#include "lib/experiment/result_record.h"
#include "lib/inference/intervals.h"
#include "lib/study/quantities.h"

namespace spool {

// Where the results of a plan come from.
struct StudySources {
  // May fail: that replicate has no result.
  std::function<Result<ResultRecord>(const Cell&)> read;
  // Samples per pixel of a recording, NaN where not known: for results of older programs.
  std::function<double(const std::string& recording)> recorded_spp;
  // The filter's image is made elsewhere, and is the same for any samples.
  std::function<bool(const MethodChoice& filter)> made_elsewhere;
};

struct MethodResults {
  MethodChoice sampler, filter;
  std::vector<std::vector<double>> values;  // [quantity][replicate]; NaN: none
  std::vector<double> pixel_errors;         // [quantity] of replicate 0, from blocks of pixels
  int pixel_blocks = 0;                     // that they are made of
  int recordings = 1;                       // of the scene: as many replicates of each
  std::set<std::size_t> with_results;       // those of the plan's that gave any
  int done = 0, failed = 0;
  bool biased = false;
  bool shared_machine = false;  // wall times are of one that other results shared
  bool made_elsewhere = false;  // the image
  std::string reference;
  TakenSamples taken;
  double shared = 0;       // share of a replicate's samples that another took too
  double correlation = 0;  // of the replicates of a metric (shared_samples.h)
  // The same of fresh samples where halves do not measure it, with crossfit: replicates share what
  // judges them, too, so that errors are alike by their share of samples and not by its square.
  double fresh_correlation = 0;
  // By metric, where it was measured: the differences of halves, and the correlation that follows.
  struct Spread {
    std::vector<HalfDifference> halves;
    double correlation = 0;
    double samples = 0;  // share of its samples that another replicate took too, where it varies
  };
  std::map<std::string, Spread> spread;
  // [replicate] errors on fresh samples, by metric; only where the plan asks for them.
  std::map<std::string, std::vector<double>> fresh;
  bool shared_known = true;  // false: the size of the recording is not known

  std::string name() const { return sampler.label() + " + " + filter.label(); }
  int given() const { return static_cast<int>(with_results.size()); }  // recordings
  double mean(std::size_t quantity) const;
  // mse and relmse in all their forms; another metric is never withheld. A form stands on the same
  // few pixels: one that leaves the worst out has others in the next recording.
  Withheld withheld(const std::string& metric) const;
  // Of the replicates of a metric that halves measure. Where few pixels carry the error, each is a
  // rare event that replicates have or have not: then they are alike by their share of samples.
  double correlation_of(const std::string& metric, const Spread& measured) const;
  Series series(std::size_t quantity) const;
  // Each value is the mean of two images of half of the recording.
  Series fresh_series(const std::string& metric) const;
  // One image, or replicates of one: intervals are those of blocks of pixels.
  bool one_image() const;
  Interval interval(std::size_t quantity) const;
};

// All methods of a plan on one scene, [threads][budget][method], the methods in the order samplers,
// then filters. Each cell is read once, those of a recording in the order of Plan::cells().
using SceneMethods = std::vector<std::vector<std::vector<MethodResults>>>;
SceneMethods read_scene(const Plan& plan, const PlanScene& scene, const StudySources& sources);

}  // namespace spool
