// Prints the table of docs/accuracy.md; the argument is the binary logarithm of the longest sum.
#include <cstdlib>
#include <tuple>

#include <fmt/core.h>

#include "lib/core/pairwise_sum.h"
#include "lib/metrics/error_metrics.h"
#include "lib/statistics/piece_statistics.h"
#include "tools/bench/accuracy/accuracy.h"

namespace spool::bench {

// Scalars by Welford's recurrence, as every piece has them.
void measure_statistics(std::vector<Row>& rows) {
  struct Domain {
    std::string name;
    double mean, width;
  };
  for (const Domain& d : {Domain{"uniform in [0, 1)", 0.5, 1.0},
                          {"mean 1e6, sigma 1e-2", 1e6, 0.0346},
                          {"mean 1e-30, sigma 3e-31", 1e-30, 1e-30}}) {
    for (const std::vector<int>& counts : {std::vector<int>{2, 3}, {16, 256, 65536}}) {
      double mean_error = 0.0, m2_error = 0.0, condition = 0.0;
      for (const int n : counts) {
        for (std::uint64_t trial = 0; trial < (n > 1000 ? 8u : 200u); ++trial) {
          ScalarStatistics s(1, 1);
          std::vector<double> values;
          for (int i = 0; i < n; ++i) {
            const double u = uniform(trial, static_cast<std::uint64_t>(i));
            values.push_back(d.mean + d.width * (u - 0.5));
            s.add(0, i + 1, values.back());
          }
          Fine mean = 0, m2 = 0;
          for (const double v : values)
            mean += v;
          mean /= n;
          for (const double v : values)
            m2 += (v - mean) * (v - mean);
          mean_error = std::max(
              mean_error, static_cast<double>(std::abs(s.mean[0] - mean) / std::abs(mean) / kUnit));
          m2_error = std::max(m2_error, static_cast<double>(std::abs(s.m2[0] - m2) / m2));
          condition =
              std::max(condition, std::abs(d.mean) / std::sqrt(static_cast<double>(m2) / n));
        }
      }
      const std::string n = fmt::format("n = {} .. {}", counts.front(), counts.back());
      rows.push_back({"statistics", "mean, " + n, d.name, mean_error, "ulp"});
      rows.push_back({"statistics", fmt::format("M2, {}, mean / sigma up to {:.1e}", n, condition),
                      d.name, m2_error, "relative"});
    }
  }
}

void measure_sums(std::vector<Row>& rows, std::uint64_t terms) {
  struct Domain {
    std::string name;
    double (*term)(std::uint64_t);
  };
  const Domain domains[] = {
      {"uniform in [0, 1)", [](std::uint64_t i) { return uniform(1, i); }},
      {"mean 1e6, sigma 1e-2",
       [](std::uint64_t i) { return 1e6 + 0.0346 * (uniform(2, i) - 0.5); }},
      {"heavy tail (exponent 1.5)",
       [](std::uint64_t i) { return std::pow(1.0 - uniform(3, i), -1 / 1.5); }},
      {"both signs, uniform in [-1, 1)",
       [](std::uint64_t i) { return 2.0 * uniform(4, i) - 1.0; }}};
  for (const Domain& d : domains) {
    const double sum =
        pairwise_sum(static_cast<std::size_t>(terms), [&](std::size_t i) { return d.term(i); });
    Fine exact = 0, lost = 0, sizes = 0;  // compensated
    for (std::uint64_t i = 0; i < terms; ++i) {
      const Fine term = d.term(i), corrected = term - lost, next = exact + corrected;
      lost = (next - exact) - corrected;
      exact = next;
      sizes += std::abs(term);
    }
    rows.push_back({"sums",
                    fmt::format("pairwise sum of 2^{} terms", static_cast<int>(std::log2(terms))),
                    d.name, static_cast<double>(std::abs(sum - exact) / sizes / kUnit),
                    "ulp of the sum of sizes"});
  }
}

void measure_metrics(std::vector<Row>& rows) {
  const int width = 512, height = 512;
  for (const auto& [name, level, step] : {std::tuple{"values in [0, 1), errors of 0.1", 0.5, 0.1},
                                          {"values of 1e6, errors of 1e-2", 1e6, 1e-2}}) {
    RgbImage estimate = make_rgb(width, height), mean = estimate, variance = estimate;
    Fine squared = 0, relative = 0, energy = 0, energy_of_reference = 0, brightness = 0;
    for (std::size_t c = 0; c < 3; ++c) {
      for (std::size_t p = 0; p < mean[c].size(); ++p) {
        mean[c][p] = level * (0.5 + uniform(5 + c, p));
        estimate[c][p] = mean[c][p] + step * (2.0 * uniform(8 + c, p) - 1.0);
        variance[c][p] = 0.1 * step * step * uniform(11 + c, p);
      }
    }
    for (std::size_t p = 0; p < mean[0].size(); ++p) {
      for (std::size_t c = 0; c < 3; ++c)
        brightness += static_cast<Fine>(kLuminanceWeights[c]) * mean[c][p];
    }
    const Fine scale = static_cast<Fine>(mean[0].size()) / brightness;
    for (std::size_t c = 0; c < 3; ++c) {
      for (std::size_t p = 0; p < mean[c].size(); ++p) {
        const Fine difference = static_cast<Fine>(estimate[c][p]) - mean[c][p];
        const Fine term = difference * difference - variance[c][p], d = scale * mean[c][p];
        squared += term;
        relative += scale * scale * term / (d * d + 0.01L);
        energy += estimate[c][p];
        energy_of_reference += mean[c][p];
      }
    }
    const Fine count = 3 * static_cast<Fine>(mean[0].size());
    MetricOptions options;
    options.perceptual = Perceptual::kNone;
    options.bootstrap.resamples = 0;
    const MetricTable table = error_metrics(estimate, {mean, variance, {}}, options);
    const auto row = [&](const char* metric, Fine exact) {
      rows.push_back(
          {"metrics", fmt::format("{}, 512 x 512", metric), name,
           static_cast<double>(std::abs(table[metric].value - exact) / std::abs(exact) / kUnit),
           "ulp"});
    };
    row("mse", squared / count);
    row("relmse", relative / count);
    row("energy_ratio", energy / energy_of_reference);
  }
}

std::vector<NamedImage> test_images(int width, int height) {
  std::vector<NamedImage> images = {{"uniform in [0, 1)", Plane(width, height)},
                                    {"mean 1e6, sigma 1e-2", Plane(width, height)},
                                    {"a firefly of 1e6", Plane(width, height)}};
  for (std::size_t p = 0; p < images[0].image.size(); ++p) {
    images[0].image[p] = images[2].image[p] = uniform(21, p);
    images[1].image[p] = 1e6 + 0.0346 * (uniform(22, p) - 0.5);
  }
  images[2].image(width / 3, height / 2) = 1e6;
  return images;
}

}  // namespace spool::bench

int main(int argc, char** argv) {
  using namespace spool::bench;
  std::vector<Row> rows;
  measure_statistics(rows);
  measure_sums(rows, std::uint64_t{1} << (argc > 1 ? std::atoi(argv[1]) : 26));
  measure_pyramid(rows);
  measure_bank(rows);
  measure_sizes(rows);
  measure_filter(rows);
  measure_metrics(rows);
  fmt::print("part,quantity,domain,largest error\n");
  for (const Row& row : rows)
    fmt::print("{},\"{}\",\"{}\",{:.2g} {}\n", row.part, row.quantity, row.domain, row.error,
               row.unit);
}
