#include "lib/study/method_results.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "lib/experiment/result_table.h"
#include "lib/inference/shared_samples.h"
#include "lib/metrics/bootstrap.h"

namespace spool {
namespace {

constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();

constexpr std::pair<const char*, const char*> kFreshColumns[] = {
    {"mse", "mse_fresh"}, {"relmse", "relmse_fresh"}, {"energy_ratio", "energy_fresh"}};

// With the time that its samples took to render, where the recording has it.
double cpu_total(const ResultRecord& record) {
  const double rendering = record.number("samples_spent") * record.number("seconds_per_sample");
  return record.number("cpu_sampling") + record.number("cpu_filtering") +
         (std::isfinite(rendering) ? rendering : 0.0);
}

// Where a quantity is read, by its place; of a metric its standard error, too.
struct Columns {
  std::vector<std::size_t> value, error;
};
constexpr std::size_t kMade = static_cast<std::size_t>(-1);  // of several columns

const Columns& columns() {
  static const Columns all = [] {
    Columns found;
    for (const Quantity& quantity : quantities()) {
      const bool made = quantity.name == kCpuTotal || quantity.name == kSamplesPerPixel;
      found.value.push_back(made ? kMade : column_index(quantity.name));
      found.error.push_back(quantity.is_metric ? column_index(quantity.name + "_se") : kMade);
    }
    return found;
  }();
  return all;
}

double value_of(const ResultRecord& record, std::size_t quantity) {
  if (columns().value[quantity] != kMade) return record.number(columns().value[quantity]);
  if (quantities()[quantity].name == kCpuTotal) return cpu_total(record);
  return record.number("samples_spent") / (record.number("width") * record.number("height"));
}

// Blocks of pixels that the standard error of one image is made of.
int blocks_of(const ResultRecord& record) {
  const double width = record.number("width"), height = record.number("height");
  if (!(width > 0.0 && height > 0.0)) return 0;
  const int side = BootstrapOptions{}.block_size;
  const auto along = [&](double pixels) { return static_cast<int>(std::ceil(pixels / side)); };
  return along(width) * along(height);
}

// Counts of all replicates together; where an older program kept none, the mean stands for all.
class Shares {
 public:
  explicit Shares(const StudySources& sources) : sources_(sources) {}

  void add(const ResultRecord& record, const std::string& recording) {
    if (!(recorded_ > 0.0)) recorded_ = record.number("recorded_spp");
    if (!std::isfinite(recorded_)) recorded_ = sources_.recorded_spp(recording);
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
  const StudySources& sources_;
  std::map<int, long long> pieces_;
  double recorded_ = kNaN, mean_ = kNaN, kurtosis_ = kNaN;
};

void add_record(MethodResults& method, const Result<ResultRecord>& found) {
  const std::vector<Quantity>& list = quantities();
  const bool usable = found && !found->failed();
  method.failed += found && found->failed();
  for (std::size_t q = 0; q < list.size(); ++q)
    method.values[q].push_back(usable ? value_of(*found, q) : kNaN);
  for (const auto& [metric, column] : kFreshColumns)
    method.fresh[metric].push_back(usable ? found->number(column) : kNaN);
  if (!usable) return;
  if (++method.done == 1) {
    for (std::size_t q = 0; q < list.size(); ++q) {
      if (list[q].is_metric) method.pixel_errors[q] = found->number(columns().error[q]);
    }
    method.pixel_blocks = blocks_of(*found);
  }
  for (const MetricHalves& halves : found->halves) {
    method.spread[halves.metric].halves.push_back(halves.difference);
    method.spread[halves.metric].halves.back().replicate =
        static_cast<int>(method.values.front().size()) - 1;
  }
  method.shared_machine = method.shared_machine || found->text("timing") == "shared";
  method.reference = found->text("reference");
  method.biased = method.biased || method.reference.ends_with("(biased)");
}

// The energy of an image is a sum of its samples: what two share makes it alike by their share,
// where squared errors are alike by its square (shared_samples.h).
bool is_linear(std::string_view metric) {
  return metric.starts_with("energy");
}

// One of the two squared errors in any of their forms.
bool is_squared(std::string_view metric) {
  return metric.starts_with("relmse") || metric.starts_with("mse") || metric == "rmse";
}

// That the mean of so many is worth.
double independent_replicates(double replicates, double correlation) {
  return replicates / (1.0 + (replicates - 1.0) * std::min(correlation, 1.0));
}

// What the replicates have in common, and how alike that makes their metrics.
void add_shared(MethodResults& method, const Plan& plan, const ReplicatePairs& pairs,
                const Shares& shares, double spp) {
  method.shared_known = shares.known();
  if (!shares.known()) return;
  const bool ring = plan.experiment.order == ReplicateOrder::kDisjoint;
  const auto shared_of = [&](const TakenSamples& taken) {
    const Shared shared =
        shared_by_replicates(taken, pairs, ring ? Taking::kOneAround : Taking::kOwnOrder);
    return Shared{over_recordings(shared.samples, plan.replicates, method.given()),
                  over_recordings(shared.correlation, plan.replicates, method.given())};
  };
  method.taken = shares.taken(spp);
  const Shared shared = shared_of(method.taken);
  method.shared = shared.samples;
  method.correlation = shared.correlation;
  const double half = 0.5 * method.taken.recorded;  // fresh samples are of a ring of so many
  method.fresh_correlation = shared_of({method.taken.counts, half, 1.0}).correlation;
  for (auto& [metric, spread] : method.spread) {
    const double around = metric.ends_with("_fresh") ? half : method.taken.recorded;
    const Shared of_halves = shared_of({varying_counts(spread.halves), around, method.taken.rare});
    spread.samples = of_halves.samples;
    spread.correlation = is_linear(metric) ? of_halves.samples : of_halves.correlation;
  }
}

// In the order samplers, then filters.
std::vector<MethodResults> without_results(const Plan& plan, const PlanScene& scene,
                                           const StudySources& sources) {
  std::vector<MethodResults> methods;
  for (const MethodChoice& sampler : plan.samplers) {
    for (const MethodChoice& filter : plan.filters) {
      MethodResults& method = methods.emplace_back();
      method.sampler = sampler;
      method.filter = filter;
      method.made_elsewhere = sources.made_elsewhere(filter);
      method.values.resize(quantities().size());
      method.pixel_errors.resize(quantities().size(), kNaN);
      method.recordings = static_cast<int>(scene.recordings.size());
    }
  }
  return methods;
}

}  // namespace

double MethodResults::mean(std::size_t quantity) const {
  return mean_interval({values[quantity], 0.0}, quantities()[quantity].range).mean;
}

double MethodResults::correlation_of(const std::string& metric, const Spread& measured) const {
  if (!is_squared(metric) || given() >= kOwnSpread) return measured.correlation;
  const std::string whole = metric.starts_with("relmse") ? "relmse" : "mse";
  const double pixels = mean(quantity_index(whole + "_half_pixels"));
  const bool few = pixels * independent_replicates(done, measured.correlation) < kFewPixels;
  return few ? measured.samples : measured.correlation;
}

Withheld MethodResults::withheld(const std::string& metric) const {
  const bool relative = metric.starts_with("relmse");
  const bool squared = is_squared(metric);
  if (!squared || one_image()) return Withheld::kNo;
  const std::string whole = relative ? "relmse" : "mse";
  if (metric != whole && withheld(whole) == Withheld::kFewPixels) return Withheld::kFewPixels;
  ErrorStanding standing;
  standing.half_pixels = mean(quantity_index(whole + "_half_pixels"));
  const auto measured = spread.find(metric);
  const double common = measured == spread.end() ? correlation : measured->second.correlation;
  standing.independent_replicates = independent_replicates(done, common);
  standing.halves = measured != spread.end();
  standing.own_spread = given() >= kOwnSpread;
  if (relative) standing.reference_noise = mean(quantity_index("relmse_reference_noise"));
  return withheld_of(standing);
}

Series MethodResults::series(std::size_t quantity) const {
  const Quantity& kind = quantities()[quantity];
  Series series{values[quantity], 0.0};
  if (!kind.is_compared) return series;
  series.recordings = recordings;
  series.withheld = withheld(kind.name);
  series.taken = taken;
  series.correlation = correlation;
  if (is_linear(kind.name)) {
    series.taken.rare = 1.0;
    series.correlation = shared;
  }
  if (const auto measured = spread.find(kind.name); measured != spread.end()) {
    series.correlation = correlation_of(kind.name, measured->second);
    series.halves = measured->second.halves;
  }
  return series;
}

Series MethodResults::fresh_series(const std::string& metric) const {
  const auto values_of = fresh.find(metric);
  if (values_of == fresh.end()) return {};
  Series series{values_of->second, fresh_correlation};
  series.recordings = recordings;
  series.withheld = withheld(metric);
  const auto measured = spread.find(metric + "_fresh");
  if (measured == spread.end()) return series;
  series.correlation = correlation_of(metric, measured->second);
  // Of the mean of the two images: their difference over the root of two has its spread.
  series.halves =
      difference_of(measured->second.halves, std::sqrt(0.5), measured->second.halves, 0.0);
  return series;
}

bool MethodResults::one_image() const {
  return done == 1 || made_elsewhere || Series{values[quantity_index("mse")], 0.0}.alike();
}

Interval MethodResults::interval(std::size_t quantity) const {
  const Quantity& kind = quantities()[quantity];
  const Series all = series(quantity);
  if (!kind.is_metric || !one_image()) return mean_interval(all, kind.range);
  const auto first =
      std::ranges::find_if(all.values, [](double value) { return std::isfinite(value); });
  return single_interval(first == all.values.end() ? kNaN : *first, pixel_errors[quantity],
                         pixel_blocks, kind.range);
}

SceneMethods read_scene(const Plan& plan, const PlanScene& scene, const StudySources& sources) {
  const PlanCells cells(plan);
  const std::size_t of_recording = cells.size() / plan.recordings.size();
  const std::size_t filters = plan.filters.size();
  SceneMethods found(plan.threads.size(), {plan.spp.size(), without_results(plan, scene, sources)});
  std::vector<Shares> shares(plan.threads.size() * plan.spp.size() * found[0][0].size(),
                             Shares(sources));
  const auto shares_of = [&](std::size_t t, std::size_t b, std::size_t m) -> Shares& {
    return shares[(t * plan.spp.size() + b) * found[0][0].size() + m];
  };
  for (std::size_t d = 0; d < plan.recordings.size(); ++d) {
    if (std::ranges::find(scene.recordings, plan.recordings[d]) == scene.recordings.end()) continue;
    for (std::size_t i = d * of_recording; i < (d + 1) * of_recording; ++i) {
      const CellPlace at = cells.place(i);
      const std::size_t m = at.sampler * filters + at.filter;
      const Result<ResultRecord> record = sources.read(cells.cell(i));
      MethodResults& method = found[at.threads][at.spp][m];
      if (record && !record->failed()) {
        shares_of(at.threads, at.spp, m).add(*record, plan.recordings[d]);
        method.with_results.insert(d);
      }
      add_record(method, record);
    }
  }
  const ReplicatePairs pairs = pairs_of(plan.replicates);
  for (std::size_t t = 0; t < found.size(); ++t) {
    for (std::size_t b = 0; b < found[t].size(); ++b) {
      for (std::size_t m = 0; m < found[t][b].size(); ++m)
        add_shared(found[t][b][m], plan, pairs, shares_of(t, b, m), plan.spp[b]);
    }
  }
  return found;
}

}  // namespace spool
