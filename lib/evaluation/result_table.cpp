#include "lib/evaluation/result_table.h"

#include <cmath>

namespace spool {
namespace {

// NaN is an empty field: not defined or not known.
std::string number(double value) {
  return std::isnan(value) ? std::string() : format_number(value);
}

template <class Value>
ResultColumn number_column(std::string name, std::string meaning, Value value) {
  return {std::move(name), std::move(meaning), true, [value](const CellResult& result) {
            return result.error ? std::string() : number(static_cast<double>(value(result)));
          }};
}

template <class Text>
ResultColumn text_column(std::string name, std::string meaning, Text text) {
  return {std::move(name), std::move(meaning), false, text};
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

double saturated_share(const CellResult& result) {
  const double pieces = static_cast<double>(result.width) * result.height * result.pieces_per_side *
                        result.pieces_per_side;
  return static_cast<double>(result.log.saturated_pieces) / pieces;
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

std::vector<ResultColumn> make_columns() {
  using R = CellResult;
  std::vector<ResultColumn> columns = {
      text_column("dump", "the recording", [](const R& r) { return r.cell.dump; }),
      text_column("sampler", "sampler, with preset and options where not the default",
                  [](const R& r) { return r.cell.sampler.label(); }),
      text_column("filter", "filter, with preset and options where not the default",
                  [](const R& r) { return r.cell.filter.label(); }),
      {"spp", "budget in samples per pixel", true,
       [](const R& r) { return format_number(r.cell.spp); }},
      {"replicate", "number of the replicate, 0 first; each shuffles the samples by its own seed",
       true, [](const R& r) { return std::to_string(r.cell.replicate); }},
  };
  add_metric_columns(columns);
  const std::vector<ResultColumn> rest = {
      number_column("efficiency", "1 / (mse * seconds_total); empty where mse <= 2 mse_se",
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
      number_column("seconds_sampling",
                    "wall time of the sampler, shared by all filters of its run",
                    [](const R& r) { return r.sampling.wall; }),
      number_column("cpu_sampling", "CPU time of the sampler, all threads",
                    [](const R& r) { return r.sampling.cpu; }),
      number_column("seconds_filtering", "wall time of the filter",
                    [](const R& r) { return r.filtering.wall; }),
      number_column("cpu_filtering", "CPU time of the filter, all threads",
                    [](const R& r) { return r.filtering.cpu; }),
      number_column("seconds_reading", "wall time of loading the recording, 0 when already loaded",
                    [](const R& r) { return r.reading.wall; }),
      number_column("seconds_per_sample",
                    "render time of a sample as recorded; empty: not recorded",
                    [](const R& r) { return r.cost_per_sample.value_or(std::nan("")); }),
      number_column("seconds_total",
                    "seconds_sampling + seconds_filtering + samples_spent * seconds_per_sample "
                    "(where recorded)",
                    seconds),
      number_column("threads", "threads allowed", [](const R& r) { return r.threads; }),
      text_column("reference", "what the image was judged by",
                  [](const R& r) {
                    if (r.error) return std::string();
                    return std::string(reference_name(r.reference)) +
                           (is_biased(r.reference) ? " (biased)" : "");
                  }),
      number_column("holdout", "samples per pixel held out of the replay",
                    [](const R& r) { return r.holdout; }),
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
      text_column("guards", "guards that caught something, name=count",
                  [](const R& r) { return r.error ? std::string() : guards_text(r.guards); }),
      text_column("error", "why there is no result; 'image not finite' where pixels are missing",
                  [](const R& r) {
                    if (r.error) return r.error->message;
                    return std::string(r.metrics.failed ? "image not finite" : "");
                  }),
  };
  columns.insert(columns.end(), rest.begin(), rest.end());
  return columns;
}

std::string csv_field(const std::string& text) {
  if (text.find_first_of(",\"\r\n") == std::string::npos) return text;
  std::string quoted = "\"";
  for (const char c : text)
    quoted += c == '"' ? std::string("\"\"") : std::string(1, c);
  return quoted + "\"";
}

}  // namespace

const std::vector<ResultColumn>& result_columns() {
  static const std::vector<ResultColumn> columns = make_columns();
  return columns;
}

std::string csv_header() {
  std::string line;
  for (const ResultColumn& column : result_columns()) {
    if (!line.empty()) line += ',';
    line += column.name;
  }
  return line;
}

std::string to_csv_row(const CellResult& result) {
  std::string line;
  for (std::size_t i = 0; i < result_columns().size(); ++i) {
    if (i > 0) line += ',';
    line += csv_field(result_columns()[i].text(result));
  }
  return line;
}

std::optional<double> efficiency(const CellResult& result) {
  if (result.error || result.metrics.values.empty()) return std::nullopt;
  const MetricValue& mse = result.metrics["mse"];
  // Written so that an unknown standard error leaves the value unresolved.
  if (!(mse.value > 2.0 * mse.standard_error)) return std::nullopt;
  return 1.0 / (mse.value * seconds(result));
}

}  // namespace spool
