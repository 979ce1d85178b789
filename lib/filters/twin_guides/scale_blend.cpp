#include "lib/filters/twin_guides/scale_blend.h"

#include <algorithm>
#include <utility>

#include "lib/filters/twin_guides/tiles.h"
#include "lib/filters/twin_guides/window_weights.h"
#include "lib/statistics/grown_variance.h"

namespace spool {
namespace {

constexpr WindowShape kWindow = {2, 1.5};
constexpr WindowShape kJoin = {3, 2.0};
constexpr double kFeatureGainOfJoin = 10.0;  // in that of the fit, which has slopes besides
constexpr int kLastStep = 8;                 // after 2 and 4
constexpr double kFloor = 0.1;               // of the picture, in L: no error is relative to less
constexpr std::size_t kTerms = 3;
// Without features coarse scales know edges from noisy guides alone, and their bias is the common
// case: their noise counts half.
constexpr double kSlackWithoutFeatures = 0.5;

// A few draws of noise that is rare say nothing: N from as many pieces as carry it.
void grow_noise(std::vector<Image<float>>& terms, const NoisePool& pool) {
  if (pool.unused()) return;
  for (std::size_t t = 1; t < terms.size(); t += kTerms) {
    Plane noise(terms[t].width(), terms[t].height());
    std::copy(terms[t].pixels().begin(), terms[t].pixels().end(), noise.pixels().begin());
    noise = grown_variance(noise, pool.radius);
    for (std::size_t i = 0; i < noise.size(); ++i)
      terms[t][i] += static_cast<float>(pool.share[i] * (noise[i] - terms[t][i]));
  }
}

// D, N and V of each detail, [3 k + term][y][x], before the means.
std::vector<Image<float>> terms_of(const std::vector<ScaleImages>& scales, float floor,
                                   const NoisePool& noise_pool) {
  const FloatRgb& picture = scales[std::min<std::size_t>(2, scales.size() - 1)].image;
  const int width = picture[0].width(), height = picture[0].height();
  std::vector<Image<float>> terms(kTerms * (scales.size() - 1), Image<float>(width, height));
  parallel_rows(0, height, [&](int y) {
    for (std::size_t i = picture[0].index(0, y); i < picture[0].index(0, y + 1); ++i) {
      for (std::size_t c = 0; c < 3; ++c) {
        const float level = std::max(picture[c][i], 0.0f);
        const float share = 1.0f / (3.0f * (level * level + floor * floor));
        for (std::size_t k = 0; k + 1 < scales.size(); ++k) {
          const float coarse = scales[k + 1].noise[c][i];
          const float d = scales[k].image[c][i] - scales[k + 1].image[c][i];
          const float e = scales[k].noise[c][i] - coarse;
          terms[kTerms * k][i] += share * d * d;
          terms[kTerms * k + 1][i] += share * e * e;
          terms[kTerms * k + 2][i] += share * e * coarse;
        }
      }
    }
  });
  grow_noise(terms, noise_pool);
  return terms;
}

void mean_on_tile(const Lattice& lattice, const Rectangle& tile, const WindowWeights& weights,
                  const std::vector<Image<float>>& from, std::vector<Image<float>>& to) {
  const int r = weights.radius(), width = whole_vectors(tile.width());
  TilePlanes around({tile.x0 - r, tile.y0 - r, tile.x1 + r, tile.y1 + r}, from.size());
  for (std::size_t i = 0; i < from.size(); ++i)
    around.copy_clamped(i, from[i], lattice);
  std::vector<float> total(static_cast<std::size_t>(width)), sum(total);
  for (int y = tile.y0; y < tile.y1; ++y) {
    for (std::size_t i = 0; i < from.size(); ++i) {
      weights.sum(around, i, tile.x0, y, width, sum.data(), total.data());
      for (int x = 0; x < tile.width(); ++x) {
        const auto at = static_cast<std::size_t>(x);
        to[i](lattice.column(tile.x0 + x), lattice.row(y)) = sum[at] / total[at];
      }
    }
  }
}

std::vector<Image<float>> guided_means(std::vector<Image<float>> terms, GuideLevels finest,
                                       const FeatureImages& clean, const RadianceScale& scale,
                                       const TwinGuidesOptions& options) {
  const int width = terms[0].width(), height = terms[0].height();
  std::vector<Image<float>> means(terms.size(), Image<float>(width, height));
  GuidePyramid pyramid(std::move(finest), scale, options);
  while (pyramid.step() < kLastStep) {
    pyramid.coarsen();
    parallel_lattice_tiles(
        width, height, pyramid.step(), [&](const Lattice& lattice, const Rectangle& tile) {
          const WindowWeights weights(lattice, tile, kWindow, pyramid, clean, options);
          mean_on_tile(lattice, tile, weights, terms, means);
        });
    std::swap(terms, means);
  }
  return terms;
}

bool anywhere(const Plane& share, const Rectangle& tile) {
  for (int y = tile.y0; y < tile.y1; ++y) {
    for (int x = tile.x0; x < tile.x1; ++x)
      if (share(x, y) > 0.0) return true;
  }
  return false;
}

// Lattices of a coarse scale share few samples. Where no finer scale covers how they differ, a mean
// over their neighbours does.
void join_lattices(FloatRgb& out, const NoisePool& pool, GuideLevels finest,
                   const FeatureImages& clean, const RadianceScale& scale,
                   const TwinGuidesOptions& options) {
  const std::vector<Image<float>> from(out.begin(), out.end());
  std::vector<Image<float>> means(from.size(), Image<float>(out[0].width(), out[0].height()));
  TwinGuidesOptions strict = options;
  strict.feature_gain *= kFeatureGainOfJoin;
  const GuidePyramid pyramid(std::move(finest), scale, options);
  parallel_lattice_tiles(
      out[0].width(), out[0].height(), 1, [&](const Lattice& lattice, const Rectangle& tile) {
        if (!anywhere(pool.share, tile)) return;
        const WindowWeights weights(lattice, tile, kJoin, pyramid, clean, strict);
        mean_on_tile(lattice, tile, weights, from, means);
      });
  for (std::size_t c = 0; c < out.size(); ++c) {
    for (std::size_t i = 0; i < out[c].size(); ++i)
      out[c][i] += static_cast<float>(pool.share[i]) * (means[c][i] - out[c][i]);
  }
}

float share_of_detail(float d, float n, float v, float slack) {
  const float signal = d - slack * (n + v);
  return signal > 0.0f ? std::min(signal / d, 1.0f) : 0.0f;
}

}  // namespace

FloatRgb blend_scales(const std::vector<ScaleImages>& scales, GuideLevels finest,
                      const FeatureImages& clean, const NoisePool& noise_pool,
                      const RadianceScale& scale, const TwinGuidesOptions& options) {
  FloatRgb out = scales.back().image;
  if (scales.size() == 1) return out;
  const std::vector<Image<float>> means = guided_means(
      terms_of(scales, static_cast<float>(kFloor * scale.mean), noise_pool),
      {nullptr, noise_pool.unused() ? std::move(finest.coarse) : finest.coarse, finest.slack},
      clean, scale, options);
  const auto slack = static_cast<float>(options.detail_slack *
                                        (clean.value.empty() ? kSlackWithoutFeatures : 1.0));
  parallel_rows(0, out[0].height(), [&](int y) {
    for (std::size_t i = out[0].index(0, y); i < out[0].index(0, y + 1); ++i) {
      for (std::size_t k = scales.size() - 1; k-- > 0;) {
        const float a = share_of_detail(means[kTerms * k][i], means[kTerms * k + 1][i],
                                        means[kTerms * k + 2][i], slack);
        for (std::size_t c = 0; c < 3; ++c)
          out[c][i] += a * (scales[k].image[c][i] - out[c][i]);
      }
    }
  });
  if (!noise_pool.unused())
    join_lattices(out, noise_pool, std::move(finest), clean, scale, options);
  return out;
}

}  // namespace spool
