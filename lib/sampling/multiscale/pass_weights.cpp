#include "lib/sampling/multiscale/pass_weights.h"

#include <algorithm>
#include <cmath>

#include "lib/core/vector_clones.h"
#include "lib/sampling/multiscale/region_sampling.h"

namespace spool {
namespace {

// Where nothing is fresh, kept is 1 and gain 0: A stays.
SPOOL_VECTOR_CLONES
void step_row(const std::int32_t* fresh, const float* kept, const float* gain, const float* now,
              const float* before, int width, float* __restrict attenuation) {
  for (int x = 0; x < width; ++x) {
    const float change = std::abs(now[x] - before[x]);  // eq 8
    attenuation[x] = kept[fresh[x]] * attenuation[x] + gain[fresh[x]] * change;
  }
}

}  // namespace

PassWeights::PassWeights(int level, const MultiscaleOptions& options)
    : update_(options.attenuation), alpha_(options.alpha), side_(1 << level) {
  if (update_ != AttenuationUpdate::kFractional) return;
  const int pieces = side_ * side_;
  for (int fresh = 0; fresh <= kMostPredicted * pieces; ++fresh) {
    const double passes = static_cast<double>(fresh) / pieces;
    const double kept = std::pow(1.0 - alpha_, passes);
    kept_.push_back(static_cast<float>(kept));
    gain_.push_back(fresh == 0 ? 0.0f : static_cast<float>((1.0 - kept) / passes));
  }
}

PassWeights::Weights PassWeights::weights_of(std::int32_t fresh, std::int32_t open) const {
  open = std::max(open, 1);
  if (open == side_ * side_) {
    const auto i = static_cast<std::size_t>(fresh);
    return {kept_[i], gain_[i]};
  }
  const double passes = static_cast<double>(fresh) / open;
  const double kept = std::pow(1.0 - alpha_, passes);
  return {static_cast<float>(kept), static_cast<float>((1.0 - kept) / passes)};
}

void PassWeights::update_entries(const RegionRow& regions, const float* now, const float* before,
                                 int begin, int end, float* attenuation) const {
  const auto alpha = static_cast<float>(alpha_);
  for (int x = begin; x < end; ++x) {
    const std::int32_t fresh = regions.fresh[x];
    const float change = std::abs(now[x] - before[x]);  // eq 8
    float& a = attenuation[x];
    switch (update_) {  // eq 7
      case AttenuationUpdate::kFractional: {
        if (fresh == 0) break;
        const std::int32_t closed = regions.closed == nullptr ? 0 : regions.closed[x];
        const Weights weights = weights_of(fresh, regions.columns[x] * regions.rows - closed);
        a = weights.kept * a + weights.gain * change;
        break;
      }
      case AttenuationUpdate::kRegion:
        if (fresh != 0) a = (1.0f - alpha) * a + alpha * change;
        break;
      case AttenuationUpdate::kAnyTouch:
        if (change > 0.0f) a = (1.0f - alpha) * a + alpha * change;
        break;
      case AttenuationUpdate::kAccumulate:
        if (fresh != 0) a = alpha * a + change;
        break;
      case AttenuationUpdate::kNone:
        break;
    }
  }
}

void PassWeights::update_row(const RegionRow& regions, const float* now, const float* before,
                             int width, float* attenuation) const {
  constexpr int kWorthIt = 8;  // entries with whole open regions, for the fast loop
  const bool fast = update_ == AttenuationUpdate::kFractional && regions.rows == side_;
  const auto is_whole = [&](int x) {
    return regions.columns[x] == side_ && (regions.closed == nullptr || regions.closed[x] == 0);
  };
  int done = 0;
  for (int begin = 0; fast && begin < width;) {
    int end = begin;
    while (end < width && is_whole(end))
      ++end;
    if (end - begin >= kWorthIt) {
      update_entries(regions, now, before, done, begin, attenuation);
      step_row(regions.fresh + begin, kept_.data(), gain_.data(), now + begin, before + begin,
               end - begin, attenuation + begin);
      done = end;
    }
    begin = end + 1;
  }
  update_entries(regions, now, before, done, width, attenuation);
}

}  // namespace spool
