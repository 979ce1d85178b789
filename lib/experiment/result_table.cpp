#include "lib/experiment/result_table.h"

#include <algorithm>
#include <cmath>
#include <filesystem>

#include <nlohmann/json.hpp>

#include "lib/core/check.h"

namespace spool {
namespace {

// NaN is an empty field: not defined or not known.
std::string number(double value) {
  return std::isnan(value) ? std::string() : format_number(value);
}

template <class Value>
ResultColumn number_column(std::string name, std::string meaning, Value value,
                           ColumnKind kind = ColumnKind::kResult) {
  return {std::move(name), std::move(meaning), true, kind, [value](const CellResult& result) {
            return result.error ? std::string() : number(static_cast<double>(value(result)));
          }};
}

template <class Value>
ResultColumn timing_column(std::string name, std::string meaning, Value value) {
  return number_column(std::move(name), std::move(meaning), value, ColumnKind::kTiming);
}

// The processor time of a stage, and the spread of its repeats.
ResultColumn cpu_column(const std::string& stage, const std::string& work,
                        StageTime CellResult::* time) {
  return timing_column("cpu_" + stage, "CPU time of " + work + ", all threads",
                       [time](const CellResult& r) { return (r.*time).cpu; });
}
ResultColumn wall_column(const std::string& stage, std::string meaning,
                         StageTime CellResult::* time) {
  return timing_column("seconds_" + stage, std::move(meaning),
                       [time](const CellResult& r) { return (r.*time).wall; });
}
ResultColumn spread_column(const std::string& stage, StageTime CellResult::* time) {
  return timing_column("seconds_" + stage + "_spread", "its slowest less its fastest repeat",
                       [time](const CellResult& r) { return (r.*time).spread; });
}

template <class Text>
ResultColumn text_column(std::string name, std::string meaning, Text text,
                         ColumnKind kind = ColumnKind::kResult) {
  return {std::move(name), std::move(meaning), false, kind, text};
}

std::string guards_text(const GuardCounts& guards) {
  std::string text;
  for (std::size_t g = 0; g < kGuardCount; ++g) {
    const auto guard = static_cast<Guard>(g);
    if (guards[guard] == 0) continue;
    text += fmt::format("{}{}={}", text.empty() ? "" : " ", guard_name(guard), guards[guard]);
  }
  return text;
}

std::string masks_text(const CellResult& result) {
  std::string text;
  for (const auto& [name, ratio] : result.masks)
    text += fmt::format("{}{}={}", text.empty() ? "" : " ", name, number(ratio.value));
  return text;
}

double saturated_share(const CellResult& result) {
  const double pieces = static_cast<double>(result.width) * result.height * result.pieces_per_side *
                        result.pieces_per_side;
  return quotient(static_cast<double>(result.log.saturated_pieces), pieces);
}

double seconds(const CellResult& result) {
  const double own = result.sampling.wall + result.filtering.wall;
  if (!result.cost_per_sample) return own;
  return own + static_cast<double>(result.log.spent) * *result.cost_per_sample;
}

void add_metric_columns(std::vector<ResultColumn>& columns) {
  for (std::size_t m = 0; m < metrics().size(); ++m) {
    const MetricDescription& metric = metrics()[m];
    columns.push_back(number_column(metric.name, metric.meaning, [m](const CellResult& result) {
      return result.metrics.values[m].value;
    }));
    columns.push_back(number_column(
        metric.name + "_se", "standard error of " + metric.name + " (block bootstrap over pixels)",
        [m](const CellResult& result) { return result.metrics.values[m].standard_error; }));
  }
}

void add_support_columns(std::vector<ResultColumn>& columns) {
  const std::pair<const char*, ErrorSupport MetricTable::*> kinds[] = {
      {"mse", &MetricTable::squared}, {"relmse", &MetricTable::relative}};
  for (const auto& [metric, kind] : kinds) {
    const auto add = [&, of = kind](const char* name, std::string meaning,
                                    double ErrorSupport::* value) {
      columns.push_back(
          number_column(fmt::format("{}_{}", metric, name), std::move(meaning),
                        [of, value](const CellResult& r) { return r.metrics.*of.*value; }));
    };
    add("worst_share", fmt::format("share of {} that the worst 0.1 % of the pixels bear", metric),
        &ErrorSupport::worst_share);
    add("half_pixels", fmt::format("how many pixels bear half of {}", metric),
        &ErrorSupport::half_pixels);
    add("reference_noise",
        fmt::format("variance of the reference in units of {}; empty: not known", metric),
        &ErrorSupport::reference_noise);
  }
}

// Empty where no fresh samples were asked for.
void add_fresh_columns(std::vector<ResultColumn>& columns) {
  const auto add = [&](std::string name, std::string meaning, double (*value)(const FreshErrors&)) {
    columns.push_back(
        number_column(std::move(name), std::move(meaning), [value](const CellResult& result) {
          return result.fresh ? value(*result.fresh) : std::nan("");
        }));
  };
  using F = FreshErrors;
  add("mse_fresh", "mse of the same counts applied to samples that had no say in them",
      [](const F& f) { return f.mse; });
  add("relmse_fresh", "relmse of those images", [](const F& f) { return f.relmse; });
  add("energy_fresh", "energy ratio of those images", [](const F& f) { return f.energy_ratio; });
  add("mse_bias2", "bias squared of the method, debiased: what more recordings would not take off",
      [](const F& f) { return f.parts.bias2; });
  add("mse_variance", "variance of the method; with mse_bias2 it is the mse of a half",
      [](const F& f) { return f.parts.variance; });
  add("relmse_bias2", "bias squared in units of relmse",
      [](const F& f) { return f.parts.relative_bias2; });
  add("relmse_variance", "variance in units of relmse",
      [](const F& f) { return f.parts.relative_variance; });
  add("halves_saturated",
      "share of the pieces of a half that ran out: above 0.01 the columns from mse_fresh on are of "
      "a shorter recording",
      [](const F& f) { return f.saturated_share; });
}

std::vector<ResultColumn> cell_columns() {
  using R = CellResult;
  constexpr ColumnKind kCell = ColumnKind::kCell;
  return {
      text_column(
          "dump", "the recording, by the name of its file without .spool",
          [](const R& r) { return std::filesystem::path(r.cell.dump).stem().string(); }, kCell),
      text_column(
          "sampler", "sampler, with preset and options where not the default",
          [](const R& r) { return r.cell.sampler.label(); }, kCell),
      text_column(
          "filter", "filter, with preset and options where not the default",
          [](const R& r) { return r.cell.filter.label(); }, kCell),
      {"spp", "budget in samples per pixel", true, kCell,
       [](const R& r) { return format_number(r.cell.spp); }},
      {"replicate", "number of the replicate, 0 first: which samples of the recording it takes",
       true, kCell, [](const R& r) { return std::to_string(r.cell.replicate); }},
      {"threads", "threads that the plan asked for; 0: as many as the process may use", true, kCell,
       [](const R& r) { return std::to_string(r.cell.threads); }},
      text_column(
          "dump_path", "the recording's path, as it was given",
          [](const R& r) { return r.cell.dump; }, kCell),
  };
}

// The sampled regions of level k have 4^k pieces.
double region_area(const CellResult& result) {
  double samples = 0.0, area = 0.0, pieces = 4.0;
  for (std::size_t k = 1; k < result.log.samples_of_level.size(); ++k, pieces *= 4.0) {
    const auto taken = static_cast<double>(result.log.samples_of_level[k]);
    samples += taken;
    area += taken * pieces;
  }
  return quotient(area, samples);
}

std::vector<ResultColumn> sample_columns() {
  using R = CellResult;
  return {
      timing_column("efficiency", "1 / (mse * seconds_total); empty where mse <= 2 mse_se",
                    [](const R& r) { return efficiency(r).value_or(std::nan("")); }),
      number_column("samples_spent", "samples taken from the recording",
                    [](const R& r) { return r.log.spent; }),
      number_column("samples_initial", "of those, taken before the first decision",
                    [](const R& r) { return r.log.initial; }),
      number_column("saturated", "pieces that ran out of recorded samples",
                    [](const R& r) { return r.log.saturated_pieces; }),
      number_column("saturated_share",
                    "saturated pieces / all pieces; above 0.01 the recording is too short",
                    saturated_share),
      number_column("block_jump",
                    "mean jump of the counts across multiples of 16 pixels / that elsewhere; above "
                    "1.2 the density shows blocks",
                    [](const R& r) { return r.density.block_jump; }),
      number_column("edge_share",
                    "share of the samples above the smallest count within 2 pixels of the tenth of "
                    "the pixels with the largest gradient; empty where all counts are equal",
                    [](const R& r) { return r.density.edge_share; }),
      number_column(
          "region_area",
          "mean area, in pieces, of the regions of levels 1 and up that the sampler chose, "
          "over their samples; empty where it has no regions",
          region_area),
  };
}

std::vector<ResultColumn> time_columns() {
  using R = CellResult;
  return {
      wall_column("sampling",
                  "wall time of the sampler, shared by all filters of its run; the median where "
                  "the plan repeats it",
                  &R::sampling),
      spread_column("sampling", &R::sampling),
      cpu_column("sampling", "the sampler", &R::sampling),
      wall_column("filtering",
                  "wall time of the filter, its analysis of the statistics included; the median "
                  "where the plan repeats it",
                  &R::filtering),
      spread_column("filtering", &R::filtering),
      cpu_column("filtering", "the filter", &R::filtering),
      timing_column("seconds_exchange",
                    "of sampling and filtering, wall time to start a command (until it opens its "
                    "input) and to write and read its files; 0 without commands. The rest is the "
                    "method's own",
                    [](const R& r) { return r.exchange_seconds; }),
      wall_column("reading", "wall time of loading the recording, 0 when already loaded",
                  &R::reading),
      cpu_column("reading", "loading the recording", &R::reading),
      wall_column("judging", "wall time of the metrics", &R::judging),
      cpu_column("judging", "the metrics", &R::judging),
      wall_column("writing", "wall time of writing the images of replicate 0", &R::writing),
      cpu_column("writing", "writing the images", &R::writing),
      number_column("seconds_per_sample",
                    "render time of a sample as recorded; empty: not recorded",
                    [](const R& r) { return r.cost_per_sample.value_or(std::nan("")); }),
      timing_column("seconds_total",
                    "seconds_sampling + seconds_filtering + samples_spent * seconds_per_sample "
                    "(where recorded)",
                    seconds),
      timing_column("peak_memory_mb",
                    "largest resident memory of the process while it sampled and filtered, 1e6 "
                    "bytes; the recording included",
                    [](const R& r) {
                      return r.peak_memory ? static_cast<double>(*r.peak_memory) / 1e6
                                           : std::nan("");
                    }),
      timing_column("threads_used", "threads that the process was allowed",
                    [](const R& r) { return r.threads; }),
      text_column(
          "timing",
          "alone: nothing else of the evaluation ran meanwhile; shared: other results were made "
          "beside it, one thread each, so wall times (and efficiency) are of a shared machine, CPU "
          "times of its thread (--timing exact: all alone)",
          [](const R& r) { return std::string(r.alone ? "alone" : "shared"); },
          ColumnKind::kTiming),
  };
}

std::vector<ResultColumn> judging_columns() {
  using R = CellResult;
  return {
      text_column("reference", "what the image was judged by",
                  [](const R& r) {
                    if (r.error) return std::string();
                    return std::string(reference_name(r.reference)) +
                           (is_biased(r.reference) ? " (biased)" : "");
                  }),
      number_column("holdout", "samples per pixel held out of the replay",
                    [](const R& r) { return r.holdout; }),
      number_column("recorded_spp", "samples per pixel of the recording, the held-out ones too",
                    [](const R& r) { return r.recorded_spp; }),
      number_column("recorded_kurtosis",
                    "excess kurtosis of the recorded samples about the mean of their pixel: 0 for "
                    "normal noise, large where rare bright samples make the variance",
                    [](const R& r) { return r.recorded_kurtosis; }),
      number_column("width", "pixels", [](const R& r) { return r.width; }),
      number_column("height", "pixels", [](const R& r) { return r.height; }),
      number_column("relative_scale", "factor on both images in the relative metrics",
                    [](const R& r) { return r.metrics.relative_scale; }),
      number_column("pixels_judged", "pixels in the metrics",
                    [](const R& r) { return r.metrics.pixels; }),
      number_column("excluded_image", "pixels left out because the image is not finite: a failure",
                    [](const R& r) { return r.metrics.excluded_estimate; }),
      number_column("excluded_reference", "pixels left out because there is no finite reference",
                    [](const R& r) { return r.metrics.excluded_reference; }),
      text_column("energy_masks", "energy ratio in the masks of the plan, name=ratio",
                  [](const R& r) { return masks_text(r); }),
      text_column("guards", "guards that caught something, name=count",
                  [](const R& r) { return r.error ? std::string() : guards_text(r.guards); }),
      text_column("error", "why there is no result; 'image not finite' where pixels are missing",
                  [](const R& r) {
                    if (r.error) return r.error->message;
                    return std::string(r.metrics.failed ? "image not finite" : "");
                  }),
  };
}

std::vector<ResultColumn> make_columns() {
  std::vector<ResultColumn> columns = cell_columns();
  add_metric_columns(columns);
  add_support_columns(columns);
  add_fresh_columns(columns);
  for (const auto& more : {sample_columns(), time_columns(), judging_columns()})
    columns.insert(columns.end(), more.begin(), more.end());
  return columns;
}

// A spreadsheet computes a text that begins like a formula, quoted or not: ' keeps it text.
std::string inert(const std::string& text) {
  return !text.empty() && std::string_view("=+-@'\t\r").find(text[0]) != std::string_view::npos
             ? "'" + text
             : text;
}

std::string csv_field(const std::string& text) {
  if (text.find_first_of(",\"\r\n") == std::string::npos) return text;
  std::string quoted = "\"";
  for (const char c : text)
    quoted += c == '"' ? std::string("\"\"") : std::string(1, c);
  return quoted + "\"";
}

std::string json_text(const std::string& text) {
  return nlohmann::json(text).dump(-1, ' ', false, nlohmann::json::error_handler_t::replace);
}

}  // namespace

const std::vector<ResultColumn>& result_columns() {
  static const std::vector<ResultColumn> columns = make_columns();
  return columns;
}

std::size_t column_index(std::string_view name) {
  const auto& columns = result_columns();
  const auto found = std::ranges::find(columns, name, &ResultColumn::name);
  SPOOL_CHECK(found != columns.end());
  return static_cast<std::size_t>(found - columns.begin());
}

std::vector<std::string> result_fields(const CellResult& result) {
  std::vector<std::string> fields;
  fields.reserve(result_columns().size());
  for (const ResultColumn& column : result_columns())
    fields.push_back(column.text(result));
  return fields;
}

std::string csv_header() {
  std::string line;
  for (const ResultColumn& column : result_columns()) {
    if (!line.empty()) line += ',';
    line += column.name;
  }
  return line;
}

std::string to_csv_row(const std::vector<std::string>& fields) {
  const std::vector<ResultColumn>& columns = result_columns();
  SPOOL_CHECK_EQ(fields.size(), columns.size());
  std::string line;
  for (std::size_t i = 0; i < fields.size(); ++i) {
    if (i > 0) line += ',';
    line += csv_field(columns[i].is_number ? fields[i] : inert(fields[i]));
  }
  return line;
}

std::string to_csv_row(const CellResult& result) {
  return to_csv_row(result_fields(result));
}

std::string to_json_line(const std::vector<std::string>& fields) {
  const std::vector<ResultColumn>& columns = result_columns();
  SPOOL_CHECK_EQ(fields.size(), columns.size());
  std::string line = "{";
  for (std::size_t i = 0; i < fields.size(); ++i) {
    const std::string& field = fields[i];
    line += i > 0 ? ",\"" : "\"";
    line += columns[i].name;
    line += "\":";
    const bool plain = columns[i].is_number && field.find_first_of("in") == std::string::npos;
    if (field.empty()) {
      line += columns[i].is_number ? "null" : "\"\"";
    } else {
      line += plain ? field : json_text(field);
    }
  }
  return line + "}";
}

std::optional<double> efficiency(const CellResult& result) {
  if (result.error || result.metrics.values.empty()) return std::nullopt;
  const MetricValue& mse = result.metrics["mse"];
  // Written so that an unknown standard error leaves the value unresolved.
  if (!std::isgreater(mse.value, 2.0 * mse.standard_error)) return std::nullopt;
  return 1.0 / (mse.value * seconds(result));
}

}  // namespace spool
