#include "lib/filters/cross_bilateral.h"

#include <algorithm>
#include <cmath>

#include "lib/core/exponential.h"
#include "lib/core/parallel.h"
#include "lib/core/vector_clones.h"
#include "lib/filters/piece_estimates.h"
#include "lib/filters/truncated_filter.h"
#include "lib/statistics/variance_option.h"

namespace spool {
namespace {

constexpr float kLeastFeatureVariance = 1e-2f;
constexpr double kLargestScale = 64.0;

using FloatImage = Image<float>;

// Features as the weights want them.
struct Guide {
  struct Feature {
    std::vector<FloatImage> value;
    FloatImage variance;  // mean over channels
    float factor = 1.0f;  // 1 / (2 sigma_f^2)
  };
  std::vector<Feature> features;
};

FloatImage to_float(const Plane& plane) {
  FloatImage image(plane.width(), plane.height());
  for (std::size_t i = 0; i < plane.size(); ++i)
    image[i] = static_cast<float>(plane[i]);
  return image;
}

Guide make_guide(const std::vector<FeatureStatistics>& features,
                 const CrossBilateralOptions& options) {
  Guide guide;
  for (const FeatureStatistics& feature : features) {
    Guide::Feature entry;
    Plane variance(feature.mean[0].width(), feature.mean[0].height());
    for (std::size_t c = 0; c < feature.mean.size(); ++c) {
      entry.value.push_back(to_float(feature.mean[c]));
      for (std::size_t i = 0; i < variance.size(); ++i)
        variance[i] += feature.variance[c][i] / static_cast<double>(feature.mean.size());
    }
    entry.variance = to_float(variance);
    const double sigma = feature.layer.name == "normal"   ? options.sigma_normal
                         : feature.layer.name == "albedo" ? options.sigma_albedo
                                                          : options.sigma_depth;
    entry.factor = static_cast<float>(1.0 / (2.0 * sigma * sigma));
    guide.features.push_back(std::move(entry));
  }
  return guide;
}

// distance += the feature's term; all rows start at the first pair.
SPOOL_VECTOR_CLONES
void add_distance(const float* p0, const float* q0, const float* p1, const float* q1,
                  const float* p2, const float* q2, const float* vp, const float* vq, float factor,
                  int count, float* distance) {
  for (int x = 0; x < count; ++x) {
    const float d0 = p0[x] - q0[x], d1 = p1[x] - q1[x], d2 = p2[x] - q2[x];
    const float sum = vp[x] + vq[x];
    const float v = sum > kLeastFeatureVariance ? sum : kLeastFeatureVariance;
    distance[x] += factor * (d0 * d0 + d1 * d1 + d2 * d2) / v;
  }
}

SPOOL_VECTOR_CLONES
void to_weights(float* distance, int count) {
  for (int x = 0; x < count; ++x)
    distance[x] = exp_negative(distance[x]);
}

SPOOL_VECTOR_CLONES
void add_weighted(const float* weight, float spatial, const double* value, int count, double* sum) {
  for (int x = 0; x < count; ++x)
    sum[x] += static_cast<double>(weight[x] * spatial) * value[x];
}

SPOOL_VECTOR_CLONES
void add_weight(const float* weight, float spatial, int count, double* sum) {
  for (int x = 0; x < count; ++x)
    sum[x] += static_cast<double>(weight[x] * spatial);
}

int radius_of(double scale) {
  return static_cast<int>(std::lround(2.0 * scale));
}

float spatial_weight(int dx, int dy, double scale) {
  return static_cast<float>(std::exp(-(dx * dx + dy * dy) / (2.0 * scale * scale)));
}

// A kernel of one scale and what it is applied to.
struct Target {
  double scale;
  std::vector<const Plane*> values;
};

struct Filtered {
  std::vector<Plane> values;
  Plane weight;  // sum of the weights; the centre's is 1
};

// Every target filtered with its scale; the feature part of a weight is computed once for all.
std::vector<Filtered> filter_targets(const Guide& guide, const std::vector<Target>& targets,
                                     int width, int height) {
  std::vector<Filtered> out;
  int radius = 0;
  for (const Target& target : targets) {
    out.push_back(
        {std::vector<Plane>(target.values.size(), Plane(width, height)), Plane(width, height)});
    radius = std::max(radius, radius_of(target.scale));
  }
  // Spatial weights per target and offset, [dy][dx] from -radius.
  const int side = 2 * radius + 1;
  std::vector<std::vector<float>> spatial(targets.size());
  for (std::size_t t = 0; t < targets.size(); ++t) {
    for (int dy = -radius; dy <= radius; ++dy) {
      for (int dx = -radius; dx <= radius; ++dx)
        spatial[t].push_back(spatial_weight(dx, dy, targets[t].scale));
    }
  }
  parallel_rows(0, height, [&](int y) {
    std::vector<float> weight(static_cast<std::size_t>(width));
    for (int dy = std::max(-radius, -y); dy <= std::min(radius, height - 1 - y); ++dy) {
      for (int dx = -radius; dx <= radius; ++dx) {
        const int x0 = std::max(0, -dx), count = std::min(width, width - dx) - x0;
        if (count <= 0) continue;
        std::fill_n(weight.begin(), count, 0.0f);
        for (const Guide::Feature& feature : guide.features) {
          const auto at = [&](std::size_t c, int x, int row) {
            return &feature.value[std::min(c, feature.value.size() - 1)](x, row);
          };
          const bool single = feature.value.size() == 1;  // then the two others add nothing
          add_distance(at(0, x0, y), at(0, x0 + dx, y + dy), at(1, x0, y),
                       single ? at(1, x0, y) : at(1, x0 + dx, y + dy), at(2, x0, y),
                       single ? at(2, x0, y) : at(2, x0 + dx, y + dy), &feature.variance(x0, y),
                       &feature.variance(x0 + dx, y + dy), feature.factor, count, weight.data());
        }
        to_weights(weight.data(), count);
        const auto offset = static_cast<std::size_t>(dy + radius) * static_cast<std::size_t>(side) +
                            static_cast<std::size_t>(dx + radius);
        for (std::size_t t = 0; t < targets.size(); ++t) {
          if (std::max(std::abs(dx), std::abs(dy)) > radius_of(targets[t].scale)) continue;
          const float s = spatial[t][offset];
          add_weight(weight.data(), s, count, &out[t].weight(x0, y));
          for (std::size_t i = 0; i < targets[t].values.size(); ++i) {
            add_weighted(weight.data(), s, &(*targets[t].values[i])(x0 + dx, y + dy), count,
                         &out[t].values[i](x0, y));
          }
        }
      }
    }
    for (Filtered& filtered : out) {
      for (Plane& values : filtered.values) {
        for (int x = 0; x < width; ++x)
          values(x, y) /= filtered.weight(x, y);
      }
    }
  });
  return out;
}

// "0/1/2/4/8"
Option<CrossBilateralOptions> scales_option() {
  using O = CrossBilateralOptions;
  return {"scales", "S/S/..., 0 .. 64, ascending", "spatial scales to choose from, pixels",
          [](O& options, std::string_view text) -> Result<void> {
            std::vector<double> scales;
            while (true) {
              const std::size_t slash = text.find('/');
              SPOOL_ASSIGN(const double scale,
                           parse_number("scales", text.substr(0, slash), 0.0, kLargestScale));
              if (!scales.empty() && !(scale > scales.back())) {
                return fail(ErrorCode::kUsage, "option scales: {} does not ascend", scale);
              }
              scales.push_back(scale);
              if (slash == std::string_view::npos) break;
              text.remove_prefix(slash + 1);
            }
            options.scales = std::move(scales);
            return {};
          },
          [](const O& options) {
            std::string text;
            for (const double scale : options.scales)
              text += (text.empty() ? "" : "/") + format_number(scale);
            return text;
          }};
}

}  // namespace

OptionTable<CrossBilateralOptions> cross_bilateral_option_table() {
  using O = CrossBilateralOptions;
  return {
      scales_option(),
      number_option<O>("risk_scale", &O::risk_scale, 0.25, kLargestScale,
                       "spatial scale of the smoothing of the risk, pixels"),
      number_option<O>("sigma_normal", &O::sigma_normal, 1e-3, 1e3, "tolerance for normals"),
      number_option<O>("sigma_albedo", &O::sigma_albedo, 1e-3, 1e3, "tolerance for albedo"),
      number_option<O>("sigma_depth", &O::sigma_depth, 1e-3, 1e3,
                       "tolerance for depth, in units of the largest"),
      var_mode_option(&O::var_mode),
      nu0_option(&O::nu0),
      number_option<O>("key", &O::key, 1e-6, 1e6, "mean of the normalised luminance"),
  };
}

Result<CrossBilateralImage> cross_bilateral(const PieceStatistics& statistics,
                                            const SamplePool& pool, double exposure,
                                            const CrossBilateralOptions& options,
                                            GuardCounts& guards) {
  if (pool.recording().features().empty()) {
    return fail(ErrorCode::kData,
                "{}: cross_bilateral needs albedo, normal or depth of each sample, which were not "
                "recorded: record them, or use a method without features",
                pool.recording().name());
  }
  SPOOL_ASSIGN(
      const PieceEstimates pieces,
      estimate_pieces(statistics, {options.var_mode, options.nu0, options.key}, exposure, guards));
  SPOOL_ASSIGN(const std::vector<FeatureStatistics> features,
               feature_statistics(pool, statistics.n, guards));
  const Guide guide = make_guide(features, options);
  const int width = statistics.width(), height = statistics.height();

  // y and v
  const Taps taps = pixel_filter_taps();
  RgbImage y = pieces.mean, v = pieces.variance;
  for (std::size_t c = 0; c < 3; ++c) {
    y[c] = truncated_mean(pieces.mean[c], taps);
    v[c] = truncated_variance(pieces.variance[c], taps, squared_taps(taps));
    for (std::size_t i = 0; i < y[c].size(); ++i) {
      y[c][i] *= exposure;
      v[c][i] *= exposure * exposure;
    }
  }

  // F_s of the means and of y
  std::vector<Target> targets;
  for (const double scale : options.scales) {
    if (scale == 0.0) continue;
    targets.push_back(
        {scale, {&pieces.mean[0], &pieces.mean[1], &pieces.mean[2], &y[0], &y[1], &y[2]}});
  }
  const std::vector<Filtered> filtered = filter_targets(guide, targets, width, height);
  const auto none = static_cast<std::size_t>(options.scales.front() == 0.0);  // scales without F

  // SURE
  std::vector<Plane> risk(options.scales.size(), Plane(width, height));
  CrossBilateralImage result;
  result.variance = Plane(width, height);
  for (std::size_t c = 0; c < 3; ++c) {
    for (std::size_t i = 0; i < v[c].size(); ++i)
      result.variance[i] += v[c][i] / 3.0;
  }
  for (std::size_t s = 0; s < risk.size(); ++s) {
    for (std::size_t c = 0; c < 3; ++c) {
      for (std::size_t i = 0; i < risk[s].size(); ++i) {
        const double f = s < none ? y[c][i] : filtered[s - none].values[3 + c][i];
        const double slope = s < none ? 1.0 : 1.0 / filtered[s - none].weight[i];
        const double d = f - y[c][i];
        risk[s][i] += (d * d + 2.0 * v[c][i] * slope - v[c][i]) / 3.0;
      }
    }
  }
  Target all_risks{options.risk_scale, {}};
  for (const Plane& plane : risk)
    all_risks.values.push_back(&plane);
  result.all = std::move(filter_targets(guide, {all_risks}, width, height)[0].values);

  // The scale of least risk
  result.image = pieces.mean;
  result.scale = CountImage(width, height);
  result.risk = result.all[0];
  for (std::size_t s = 0; s < risk.size(); ++s) {
    for (std::size_t i = 0; i < result.risk.size(); ++i) {
      if (s > 0 && !(result.all[s][i] < result.risk[i])) continue;
      result.risk[i] = result.all[s][i];
      result.scale[i] = static_cast<std::int32_t>(s);
      for (std::size_t c = 0; c < 3; ++c)
        result.image[c][i] = s < none ? pieces.mean[c][i] : filtered[s - none].values[c][i];
    }
  }
  return result;
}

}  // namespace spool
