// Slow twin of lib/sampling/multiscale: every step reads all taken samples again, analyses the
// whole image by definition and sorts every entry. Whole images only (no tiles).
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <vector>

#include "lib/sampling/multiscale/options.h"
#include "lib/sampling/priority_maxima.h"
#include "tests/reference/laplacian_pyramid_reference.h"
#include "tests/reference/region_mean_reference.h"

namespace spool::reference {

struct MultiscaleRun {
  CountImage n;
  std::vector<std::vector<Plane>> attenuation;  // [scalar][k]
  std::vector<Plane> priority;                  // P_1 .. P_K at the end
  std::vector<long long> samples_of_level;
};

class Multiscale {
 public:
  Multiscale(const SamplePool& pool, const MultiscaleOptions& options) : pool_(pool), o_(options) {}

  MultiscaleRun run(long long budget) {
    const int width = pool_.width(), height = pool_.height();
    const int first = o_.init_spp.value_or(default_initial_samples(budget, pool_));
    n_ = CountImage(width, height);
    long long spent = 0;
    for_pieces([&](int x, int y) {
      n_(x, y) = std::min(first, pool_.capacity(x, y));
      spent += n_(x, y);
    });
    const long long adaptive = std::min(budget, pool_.total_capacity()) - spent;
    exposure_ = o_.exposure == ExposureMode::kNormalise ? exposure() : 1.0;
    levels_.assign(static_cast<std::size_t>(o_.levels()) + 1, 0);
    start_attenuation();
    const long long epochs = epoch_count(o_);
    const long long share = o_.update == UpdateMode::kExact ? 1 : (adaptive + epochs - 1) / epochs;
    long long left = adaptive;
    while (left > 0)
      left -= take_step(std::min(share, left), left);
    return {n_, attenuation_, priorities(analyse()), levels_};
  }

 private:
  struct Analysis {
    Pyramid pyramid;
    std::vector<Plane> variance;  // [k], k = 0 unused
  };

  template <class Body>
  void for_pieces(Body&& body) const {
    for (int y = 0; y < pool_.height(); ++y) {
      for (int x = 0; x < pool_.width(); ++x)
        body(x, y);
    }
  }

  std::size_t scalars() const { return o_.channels == AnalysedChannels::kPerChannel ? 3 : 1; }

  double value(std::size_t i, const Rgb& c) const {
    double v = luminance(c[0], c[1], c[2]);
    if (o_.channels == AnalysedChannels::kMaxRgb) v = std::max({c[0], c[1], c[2]});
    if (o_.channels == AnalysedChannels::kPerChannel) v = c[i];
    return v * exposure_;
  }

  double exposure() const {
    std::vector<double> means;
    for_pieces([&](int x, int y) {
      double sum = 0.0;
      for (int s = 0; s < n_(x, y); ++s) {
        const Rgb c = pool_.sample(x, y, s);
        sum += luminance(c[0], c[1], c[2]);
      }
      means.push_back(sum / n_(x, y));
    });
    std::sort(means.begin(), means.end());
    means.resize(means.size() - means.size() / 100);
    double sum = 0.0;
    for (const double mean : means)
      sum += mean;
    return 1.0 / (sum / static_cast<double>(means.size()));
  }

  Plane means(std::size_t i) const {
    Plane mean(pool_.width(), pool_.height());
    for_pieces([&](int x, int y) {
      double sum = 0.0;
      for (int s = 0; s < n_(x, y); ++s)
        sum += value(i, pool_.sample(x, y, s));
      mean(x, y) = sum / n_(x, y);
    });
    return mean;
  }

  double squared_contrast_of(double low, double high) const {
    if (o_.contrast == ContrastForm::kLiteral) {
      const double sum = high + low;
      return std::abs(sum) < 1e-30 ? 0.0 : (high - low) * (high - low) / (sum * sum);
    }
    const double c = (high - low) / (std::abs(high) + std::abs(low) + 1e-4);
    return c * c;
  }

  PyramidOptions pyramid_options() const {
    PyramidOptions pyramid = o_.pyramid;
    if (o_.detail_index == DetailIndex::kSameK) ++pyramid.levels;
    return pyramid;
  }

  std::vector<Analysis> analyse() const {
    std::vector<Analysis> result;
    for (std::size_t i = 0; i < scalars(); ++i) {
      Analysis a;
      a.pyramid = reference::build_pyramid(means(i), pyramid_options());
      Plane low(n_.width(), n_.height()), high = low, contrast = low;
      for_pieces([&](int x, int y) {
        low(x, y) = std::numeric_limits<double>::infinity();
        high(x, y) = -low(x, y);
        for (int s = 0; s < n_(x, y); ++s) {
          const double v = value(i, pool_.sample(x, y, s));
          low(x, y) = std::min(low(x, y), v);
          high(x, y) = std::max(high(x, y), v);
        }
        if (n_(x, y) >= 2) contrast(x, y) = squared_contrast_of(low(x, y), high(x, y));
      });
      for (int k = 0; k <= o_.levels(); ++k)
        a.variance.push_back(reference::region_mean(contrast, k));
      result.push_back(std::move(a));
    }
    return result;
  }

  template <class Body>
  void for_region(int k, int x, int y, Body&& body) const {
    const int half = k == 0 ? 0 : 1 << (k - 1);
    for (int v = y - half; v <= (k == 0 ? y : y + half - 1); ++v) {
      for (int u = x - half; u <= (k == 0 ? x : x + half - 1); ++u) {
        if (n_.bounds().contains(u, v)) body(u, v);
      }
    }
  }

  std::vector<Plane> priorities(const std::vector<Analysis>& analyses) const {
    std::vector<Plane> result;
    for (int k = 1; k <= o_.levels(); ++k) {
      Plane p(n_.width(), n_.height(), -std::numeric_limits<double>::infinity());
      for_pieces([&](int x, int y) {
        int open = 0;
        for_region(k, x, y, [&](int u, int v) { open += n_(u, v) < pool_.capacity(u, v); });
        if (open == 0) return;
        for (std::size_t i = 0; i < analyses.size(); ++i) {
          const auto l = static_cast<std::size_t>(k);
          const std::size_t j = o_.detail_index == DetailIndex::kSameK ? l : l - 1;
          const double f = analyses[i].pyramid.coarse[l](x, y);
          double d = analyses[i].pyramid.detail[j](x, y);
          d *= d;
          if (o_.detail_norm == DetailNorm::kRelative) d /= f * f + 0.01;
          if (o_.detail_norm == DetailNorm::kOff) d = 0.0;
          const double a = attenuation_[i][l](x, y);
          p(x, y) = std::max(p(x, y), (analyses[i].variance[l](x, y) + d) * a);
        }
      });
      result.push_back(p);
    }
    return result;
  }

  void start_attenuation() {
    const auto count = static_cast<std::size_t>(o_.levels()) + 1;
    attenuation_.assign(scalars(), std::vector<Plane>(count, Plane(n_.width(), n_.height(), 1.0)));
  }

  // Pops until `share` samples are chosen, then updates A; returns the samples taken.
  long long take_step(long long share, long long left) {
    const std::vector<Analysis> before = analyse();
    const std::vector<Plane> priority = priorities(before);
    std::vector<RegionEntry> entries;
    for (int k = 1; k <= o_.levels(); ++k) {
      for_pieces([&](int x, int y) {
        const double p = priority[static_cast<std::size_t>(k - 1)](x, y);
        if (p > 0.0) entries.push_back({k, x, y, p});
      });
    }
    SPOOL_CHECK(!entries.empty());  // the twin knows no uniform remainder
    std::sort(entries.begin(), entries.end(), precedes);
    CountImage fresh(n_.width(), n_.height()), taken = fresh;
    long long chosen = 0;
    double lowest = 0.0;
    for (const RegionEntry& entry : entries) {
      bool free = true;
      for_region(entry.level, entry.x, entry.y, [&](int u, int v) { free = free && !taken(u, v); });
      if (!free) continue;
      int each = 1;
      const bool predicted =
          o_.update == UpdateMode::kEpoch && o_.step_counts == StepCounts::kPredicted;
      while (predicted && lowest_ > 0.0 && each < 8 &&
             (each + 1.0) * (each + 1.0) * lowest_ <= entry.priority)
        ++each;
      lowest = entry.priority;
      const long long got = choose(entry, each, left - chosen, taken, fresh);
      levels_[static_cast<std::size_t>(entry.level)] += got;
      chosen += got;
      if (o_.update == UpdateMode::kExact || chosen >= share) break;
    }
    lowest_ = lowest;
    CountImage closed(n_.width(), n_.height());
    for_pieces([&](int x, int y) { closed(x, y) = n_(x, y) >= pool_.capacity(x, y); });
    for_pieces([&](int x, int y) { n_(x, y) += fresh(x, y); });
    update_attenuation(before, fresh, closed);
    return chosen;
  }

  long long choose(const RegionEntry& entry, int each, long long left, CountImage& taken,
                   CountImage& fresh) const {
    std::vector<std::array<int, 3>> pieces;  // n, y, x
    long long area = 0;
    for_region(entry.level, entry.x, entry.y, [&](int u, int v) {
      ++area;
      taken(u, v) = 1;
      if (n_(u, v) < pool_.capacity(u, v)) pieces.push_back({n_(u, v), v, u});
    });
    std::sort(pieces.begin(), pieces.end());
    while (each > 1 && area * each > left)
      --each;
    long long got = 0;
    for (std::size_t i = 0; i < pieces.size() && got < left; ++i) {
      const int y = pieces[i][1], x = pieces[i][2];
      fresh(x, y) = std::min(each, pool_.capacity(x, y) - pieces[i][0]);
      got += fresh(x, y);
    }
    return got;
  }

  void update_attenuation(const std::vector<Analysis>& before, const CountImage& fresh,
                          const CountImage& closed) {
    if (o_.attenuation == AttenuationUpdate::kNone) return;
    const std::vector<Analysis> now = analyse();
    for (std::size_t i = 0; i < now.size(); ++i) {
      for (int k = 0; k <= o_.levels(); ++k) {
        const auto l = static_cast<std::size_t>(k);
        for_pieces([&](int x, int y) {
          double m = 0.0, open = 0.0;
          for_region(k, x, y, [&](int u, int v) {
            m += fresh(u, v);
            open += 1 - closed(u, v);
          });
          const double c = m / std::max(open, 1.0);
          const double change =
              std::abs(now[i].pyramid.coarse[l](x, y) - before[i].pyramid.coarse[l](x, y));
          double& a = attenuation_[i][l](x, y);
          switch (o_.attenuation) {
            case AttenuationUpdate::kFractional: {
              if (m == 0.0) break;
              const double w = 1.0 - std::pow(1.0 - o_.alpha, c);
              a = (1.0 - w) * a + w * change / c;
              break;
            }
            case AttenuationUpdate::kRegion:
              if (m > 0.0) a = (1.0 - o_.alpha) * a + o_.alpha * change;
              break;
            case AttenuationUpdate::kAnyTouch:
              if (change > 0.0) a = (1.0 - o_.alpha) * a + o_.alpha * change;
              break;
            case AttenuationUpdate::kAccumulate:
              if (m > 0.0) a = o_.alpha * a + change;
              break;
            case AttenuationUpdate::kNone:
              break;
          }
        });
      }
    }
  }

  const SamplePool& pool_;
  const MultiscaleOptions& o_;
  double exposure_ = 1.0;
  double lowest_ = 0.0;  // priority of the last region of the last step
  CountImage n_;
  std::vector<std::vector<Plane>> attenuation_;
  std::vector<long long> levels_;
};

}  // namespace spool::reference
