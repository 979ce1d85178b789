#include "tools/batch/method_results.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "formats/spool_reader.h"
#include "lib/core/check.h"
#include "lib/experiment/plan_cells.h"
#include "lib/inference/shared_samples.h"
#include "lib/metrics/error_metrics.h"
#include "tools/methods/external_methods.h"
#include "tools/methods/replicate_images.h"

namespace spool::tools {
namespace {

constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();

constexpr const char* kCpuTotal = "cpu_total";

constexpr std::pair<const char*, const char*> kFreshColumns[] = {
    {"mse", "mse_fresh"}, {"relmse", "relmse_fresh"}, {"energy_ratio", "energy_fresh"}};

std::vector<Quantity> make_quantities() {
  std::vector<Quantity> list;
  for (const MetricDescription& metric : metrics()) {
    const Range range = metric.better == Better::kHigher ? Range::kReal : Range::kPositive;
    list.push_back({metric.name, range, true});
  }
  for (const char* name :
       {"seconds_total", kCpuTotal, "seconds_sampling", "seconds_filtering", "cpu_sampling",
        "cpu_filtering", "seconds_exchange", "seconds_reading", "seconds_judging",
        "seconds_writing", "peak_memory_mb", "samples_per_pixel", "efficiency"})
    list.push_back({name});
  for (const char* name : {"saturated_share", "mse_worst_share", "relmse_worst_share"})
    list.push_back({name, Range::kShare});
  for (const char* name :
       {"mse_half_pixels", "relmse_half_pixels", "mse_reference_noise", "relmse_reference_noise"})
    list.push_back({name});
  return list;
}

// With the time that its samples took to render, where the recording has it.
double cpu_total(const ResultRecord& record) {
  const double rendering = record.number("samples_spent") * record.number("seconds_per_sample");
  return record.number("cpu_sampling") + record.number("cpu_filtering") +
         (std::isfinite(rendering) ? rendering : 0.0);
}

double value_of(const ResultRecord& record, const std::string& quantity) {
  if (quantity == kCpuTotal) return cpu_total(record);
  if (quantity != "samples_per_pixel") return record.number(quantity);
  return record.number("samples_spent") / (record.number("width") * record.number("height"));
}

// Of a recording by its results, by its file where they are of an older program.
double recorded_spp(const ResultRecord& record, const std::string& dump) {
  const double said = record.number("recorded_spp");
  if (std::isfinite(said)) return said;
  const auto reader = format::SpoolReader::open(dump);
  return reader ? static_cast<double>(reader->header().spp) : kNaN;
}

// Counts of all replicates together; where an older program kept none, the mean stands for all.
class Shares {
 public:
  void add(const ResultRecord& record, const std::string& dump) {
    if (!(recorded_ > 0.0)) recorded_ = recorded_spp(record, dump);
    if (const double kurtosis = record.number("recorded_kurtosis"); std::isfinite(kurtosis)) {
      kurtosis_ = std::isnan(kurtosis_) ? kurtosis : std::max(kurtosis_, kurtosis);
    }
    if (record.counts.empty()) {
      mean_ = record.number("samples_spent") / (record.number("width") * record.number("height"));
    }
    for (const auto& [samples, pieces] : record.counts)
      pieces_[samples] += pieces;
  }

  bool known() const { return recorded_ > 0.0 && (!pieces_.empty() || std::isfinite(mean_)); }

  // `spp`: the budget, of which the mean of a pixel's samples is made.
  TakenSamples taken(double spp) const {
    TakenSamples found{{pieces_.begin(), pieces_.end()}, recorded_, rare_share(kurtosis_, spp)};
    if (found.counts.empty()) found.counts.emplace_back(static_cast<int>(std::lround(mean_)), 1);
    return found;
  }

 private:
  std::map<int, long long> pieces_;
  double recorded_ = kNaN, mean_ = kNaN, kurtosis_ = kNaN;
};

void add_record(MethodResults& method, const Result<ResultRecord>& found) {
  const std::vector<Quantity>& list = quantities();
  const bool usable = found && !found->failed();
  method.failed += found && found->failed();
  for (std::size_t q = 0; q < list.size(); ++q)
    method.values[q].push_back(usable ? value_of(*found, list[q].name) : kNaN);
  for (const auto& [metric, column] : kFreshColumns)
    method.fresh[metric].push_back(usable ? found->number(column) : kNaN);
  if (!usable) return;
  if (++method.done == 1) {
    for (std::size_t q = 0; q < list.size(); ++q) {
      if (list[q].is_metric) method.pixel_errors[q] = found->number(list[q].name + "_se");
    }
  }
  for (const MetricHalves& halves : found->halves)
    method.spread[halves.metric].halves.push_back(halves.difference);
  method.reference = found->text("reference");
  method.biased = method.biased || method.reference.ends_with("(biased)");
}

}  // namespace

const std::vector<Quantity>& quantities() {
  static const std::vector<Quantity> list = make_quantities();
  return list;
}

std::size_t quantity_index(const std::string& name) {
  const auto found = std::ranges::find(quantities(), name, &Quantity::name);
  SPOOL_CHECK(found != quantities().end());
  return static_cast<std::size_t>(found - quantities().begin());
}

double MethodResults::mean(std::size_t quantity) const {
  return mean_interval({values[quantity], 0.0}, quantities()[quantity].range).mean;
}

Withheld MethodResults::withheld(const std::string& metric) const {
  if ((metric != "mse" && metric != "relmse") || one_image()) return Withheld::kNo;
  ErrorStanding standing;
  standing.half_pixels = mean(quantity_index(metric + "_half_pixels"));
  const auto measured = spread.find(metric);
  const double common = measured == spread.end() ? correlation : measured->second.correlation;
  standing.independent_replicates = done / (1.0 + (done - 1.0) * std::min(common, 1.0));
  standing.own_spread = recordings >= kOwnSpread;
  if (metric == "relmse") standing.reference_noise = mean(quantity_index("relmse_reference_noise"));
  return withheld_of(standing);
}

Series MethodResults::series(std::size_t quantity) const {
  const Quantity& kind = quantities()[quantity];
  Series series{values[quantity], 0.0};
  if (!kind.is_metric) return series;
  series.recordings = recordings;
  series.withheld = withheld(kind.name);
  series.taken = taken;
  series.correlation = correlation;
  if (const auto measured = spread.find(kind.name); measured != spread.end()) {
    series.correlation = measured->second.correlation;
    series.halves = measured->second.halves;
  }
  return series;
}

Series MethodResults::fresh_series(const std::string& metric) const {
  const auto values_of = fresh.find(metric);
  if (values_of == fresh.end()) return {};
  Series series{values_of->second, 0.0};
  series.recordings = recordings;
  series.withheld = withheld(metric);
  const auto measured = spread.find(metric + "_fresh");
  if (measured == spread.end()) return series;
  series.correlation = measured->second.correlation;
  // Of the mean of the two images: their difference over the root of two has its spread.
  series.halves =
      difference_of(measured->second.halves, std::sqrt(0.5), measured->second.halves, 0.0);
  return series;
}

bool MethodResults::one_image() const {
  const Filter* method = find_method(known_filters(), filter.name);
  const bool made_elsewhere =
      method != nullptr && !method->needs.samples && !is_of_replicates(filter);
  return done == 1 || made_elsewhere || Series{values[quantity_index("mse")], 0.0}.alike();
}

Interval MethodResults::interval(std::size_t quantity) const {
  const Quantity& kind = quantities()[quantity];
  const Series all = series(quantity);
  if (!kind.is_metric || !one_image()) return mean_interval(all, kind.range);
  const auto first =
      std::ranges::find_if(all.values, [](double value) { return std::isfinite(value); });
  return single_interval(first == all.values.end() ? kNaN : *first, pixel_errors[quantity],
                         kind.range);
}

std::vector<MethodResults> read_methods(const Plan& plan, const PlanScene& scene, double spp,
                                        int threads, const ReadRecord& read) {
  std::vector<MethodResults> methods;
  for (const MethodChoice& sampler : plan.samplers) {
    for (const MethodChoice& filter : plan.filters) {
      MethodResults method;
      method.sampler = sampler;
      method.filter = filter;
      method.values.resize(quantities().size());
      method.pixel_errors.resize(quantities().size(), kNaN);
      method.recordings = static_cast<int>(scene.recordings.size());
      Shares shares;
      for (const std::string& dump : scene.recordings) {
        for (int r = 0; r < plan.replicates; ++r) {
          const Result<ResultRecord> found = read({dump, sampler, filter, spp, r, threads});
          if (found && !found->failed()) shares.add(*found, dump);
          add_record(method, found);
        }
      }
      method.shared_known = shares.known();
      if (shares.known()) {
        const bool ring = plan.experiment.order == ReplicateOrder::kDisjoint;
        method.taken = shares.taken(spp);
        const Shared shared = shared_by_replicates(method.taken, plan.replicates,
                                                   ring ? Taking::kOneAround : Taking::kOwnOrder);
        method.shared = over_recordings(shared.samples, plan.replicates, method.recordings);
        method.correlation =
            over_recordings(shared.correlation, plan.replicates, method.recordings);
        for (auto& [metric, spread] : method.spread) {
          // A half is a ring of half as many samples.
          const double ring_length = metric.ends_with("_fresh") ? 0.5 : 1.0;
          const TakenSamples varying{varying_counts(spread.halves),
                                     ring_length * method.taken.recorded, method.taken.rare};
          spread.correlation =
              over_recordings(shared_by_replicates(varying, plan.replicates,
                                                   ring ? Taking::kOneAround : Taking::kOwnOrder)
                                  .correlation,
                              plan.replicates, method.recordings);
        }
      }
      methods.push_back(std::move(method));
    }
  }
  return methods;
}

}  // namespace spool::tools
