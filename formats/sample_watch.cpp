#include "formats/sample_watch.h"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <utility>

#include <fmt/core.h>

#include "formats/order_statistics.h"
#include "formats/stored_value.h"
#include "lib/core/random.h"

namespace spool::format {
namespace {

constexpr uint64_t kMostPixels = 16384;
constexpr double kLeastBits = 64;     // of evidence that alike images are no chance
constexpr size_t kNeighbours = 32;    // in the order of the first sum, where alike images meet
constexpr uint32_t kLeastImages = 8;  // for a statement on their order
constexpr double kSurely = 6.1;       // standard deviations: 1e-9, two-sided
constexpr uint32_t kLeastRun = 3, kLeastStopped = 64;

float luminance(float r, float g, float b) {
  return 0.2126F * r + 0.7152F * g + 0.0722F * b;
}

// [0, 1]; what is not finite or below 0 has a place, too.
float tone(float value, float scale) {
  if (!(value > 0)) return 0;
  return value < 1e30F ? value / (value + scale) : 1;
}

}  // namespace

SampleWatch::SampleWatch(uint32_t width, uint32_t height, uint32_t spp, bool shared_places)
    : width_(width),
      spp_(spp),
      shared_places_(shared_places),
      sums_(spp),
      light_(spp, 0.0),
      least_(spp, 2.0F),
      most_(spp, -1.0F) {
  const uint64_t pixels = uint64_t{width} * height;
  stride_ = static_cast<uint32_t>((pixels + kMostPixels - 1) / kMostPixels);
  while (stride_ > 1 && std::gcd(stride_, width) > 1)  // pixels of all columns
    ++stride_;
  courses_.resize((pixels + stride_ - 1) / stride_);
}

// A block's pixels that are watched: luminance of their samples, into `values`.
template <class Each>
void SampleWatch::each_pixel(const PixelRect& rect, uint32_t count, DataType type,
                             std::span<const std::byte> planes, Each each) {
  const size_t plane = planes.size() / 3;
  std::vector<float> values(count);
  for (uint32_t y = rect.y0; y < rect.y1; ++y) {
    for (uint32_t x = rect.x0; x < rect.x1; ++x) {
      const uint64_t pixel = uint64_t{y} * width_ + x;
      if (pixel % stride_ != 0) continue;
      const size_t at = (size_t{y - rect.y0} * rect.width() + (x - rect.x0)) * count;
      for (uint32_t s = 0; s < count; ++s)
        values[s] = luminance(stored_value(planes, type, at + s),
                              stored_value(planes.subspan(plane), type, at + s),
                              stored_value(planes.subspan(2 * plane), type, at + s));
      each(pixel, std::span(values));
    }
  }
}

void SampleWatch::add(const PixelRect& rect, uint32_t begin, uint32_t count, DataType type,
                      std::span<const std::byte> planes) {
  if (scale_ == 0) {
    double sum = 0, n = 0;
    each_pixel(rect, count, type, planes, [&](uint64_t, std::span<const float> values) {
      for (const float value : values)
        sum += value > 0 && value < 1e30F ? value : 0;
      n += count;
    });
    scale_ = static_cast<float>(sum / std::max(n, 1.0));
  }
  std::vector<float> sums(kSums * count, 0.0F), all(count, 0.0F);
  each_pixel(rect, count, type, planes, [&](uint64_t pixel, std::span<float> values) {
    for (float& value : values)
      value = tone(value, scale_);
    const uint64_t signs = splitmix64(pixel);
    for (size_t j = 0; j < kSums; ++j) {
      const float sign = (signs >> j & 1) != 0 ? 1.0F : -1.0F;
      for (uint32_t s = 0; s < count; ++s)
        sums[j * count + s] += sign * values[s];
    }
    for (uint32_t s = 0; s < count; ++s)
      all[s] += values[s];
    follow(courses_[pixel / stride_], begin, values);
  });
  for (uint32_t s = 0; s < count; ++s) {
    light_[begin + s] += all[s];
    for (size_t j = 0; j < kSums; ++j)
      sums_[begin + s][j] += sums[j * count + s];
  }
}

void SampleWatch::follow(Course& course, uint32_t begin, std::span<const float> values) {
  Course now = course;
  for (size_t s = 0; s < values.size(); ++s) {
    const float value = values[s];
    least_[begin + s] = std::min(least_[begin + s], value);
    most_[begin + s] = std::max(most_[begin + s], value);
    const float step = std::abs(value - now.last);
    const float before = std::exchange(now.last, value);
    if (begin + s == 1) now.second = value;
    if (begin + s > 1 && now.first != now.second) {
      now.forward += before == now.first && value == now.second;
      now.backward += before == now.second && value == now.first;
    }
    if (begin + s == 0) {
      now.first = value;
      now.run = 1;
      continue;
    }
    now.same += step <= kSamePixel;
    now.close += step <= kClosePixel;
    if (step == 0) {
      ++now.run;
      continue;
    }
    now.equal_between = now.equal_between || (now.head != 0 && now.run > 1);
    if (now.head == 0) now.head = now.run;
    now.run = 1;
  }
  course = now;
}

// Whether independent images are alike with a chance below 2^-64, from how often the samples of a
// pixel are. Where pixels share places, they change together unless most of them are noisy.
bool SampleWatch::evident(uint32_t Course::* alike) const {
  double bits = 0;
  for (const Course& course : courses_)
    bits -= std::log2((course.*alike + 1.0) / spp_);
  return bits >= std::max(kLeastBits, shared_places_ ? static_cast<double>(courses_.size()) : 0.0);
}

bool SampleWatch::one_value(uint32_t image) const {
  return most_[image] - least_[image] <= kSamePixel;
}

// Root mean square difference of two images, estimated.
double SampleWatch::distance(uint32_t a, uint32_t b) const {
  double sum = 0;
  for (size_t j = 0; j < kSums; ++j)
    sum += (sums_[a][j] - sums_[b][j]) * (sums_[a][j] - sums_[b][j]);
  return std::sqrt(sum / static_cast<double>(kSums * courses_.size()));
}

std::string SampleWatch::repeated() const {
  bool all_alike = !one_value(0);
  for (uint32_t s = 1; s < spp_ && all_alike; ++s)
    all_alike = distance(0, s) <= kSame;
  if (all_alike) return fmt::format("all {} images are alike: the seed did not change", spp_);
  if (!evident(&Course::same)) return {};
  const double tolerance = evident(&Course::close) ? kClose : kSame;
  std::vector<uint32_t> order(spp_);
  std::iota(order.begin(), order.end(), 0U);
  std::sort(order.begin(), order.end(), [&](uint32_t a, uint32_t b) {
    return std::pair(sums_[a][0], a) < std::pair(sums_[b][0], b);
  });
  std::vector<uint32_t> first(spp_);
  std::iota(first.begin(), first.end(), 0U);
  for (size_t i = 0; i < order.size(); ++i) {
    for (size_t j = i + 1; j < std::min(order.size(), i + kNeighbours); ++j) {
      const auto [a, b] = std::minmax(order[i], order[j]);
      if (first[b] == b && !one_value(a) && distance(a, b) <= tolerance) first[b] = a;
    }
  }
  uint32_t again = spp_, count = 0;
  for (uint32_t s = spp_; s-- > 0;) {
    if (first[s] == s) continue;
    again = s;
    ++count;
  }
  if (count == 0) return {};
  return fmt::format("image {} is {}image {} again, {} of {} are repeated: a seed started again",
                     again, distance(first[again], again) <= kSame ? "" : "almost ", first[again],
                     count, spp_);
}

// The mean of k images differs from that of k + 1 by a square that falls as 1 / (k (k + 1)):
// slope -1 of its logarithm on that of k (k + 1), where images in no order have 0.
std::string SampleWatch::running_mean() const {
  if (spp_ < kLeastImages) return {};
  std::vector<double> x, y;
  for (uint32_t k = 1; k < spp_; ++k) {
    const double step = distance(k - 1, k);
    if (step <= kSame) continue;
    x.push_back(std::log(static_cast<double>(k) * (k + 1.0)));
    y.push_back(2 * std::log(step));
  }
  if (x.size() + 2 < kLeastImages) return {};
  const Slope slope = fit_slope(x, y);
  if (slope.value > -0.5 || slope.value > -5 * slope.error) return {};
  return "each image differs less from the one before it: they are running means or sums";
}

// Images in no order are no more like the next one than like any other. By ranks, so that fireflies
// do not decide; sums that go together count as fewer.
std::string SampleWatch::moving_mean() const {
  if (spp_ < kLeastImages) return {};
  std::vector<std::vector<double>> ranks;
  for (size_t j = 0; j < kSums; ++j) {
    std::vector<double> sums(spp_);
    for (uint32_t s = 0; s < spp_; ++s)
      sums[s] = sums_[s][j];
    ranks.push_back(unit_ranks(sums));
  }
  double next = 0, together = 0;
  for (const std::vector<double>& a : ranks) {
    next += std::inner_product(a.begin(), a.end() - 1, a.begin() + 1, 0.0);
    for (const std::vector<double>& b : ranks) {
      const double dot = std::inner_product(a.begin(), a.end(), b.begin(), 0.0);
      together += dot * dot;
    }
  }
  const double correlation = next / kSums + 1.0 / spp_;
  const double independent = kSums * kSums / std::max(together, 1.0);
  return correlation * std::sqrt(spp_ * independent) > kSurely
             ? "each image is like the one before it: they are moving means, or one path goes on"
             : "";
}

std::string SampleWatch::trend() const {
  if (spp_ < kLeastImages) return {};
  const double brighter = order_score(light_);
  if (std::abs(brighter) > kSurely)
    return fmt::format("the images get {} from the first to the last",
                       brighter > 0 ? "brighter" : "darker");
  std::vector<double> to_last;
  for (uint32_t s = 0; s + 1 < spp_; ++s)
    to_last.push_back(distance(s, spp_ - 1));
  return order_score(to_last) < -kSurely ? "the later an image, the more it is like the last one"
                                         : "";
}

// Pixels that vary and then hold one value to the end, against those that do so the other way
// round, which samples in no order have as often. Where pixels share places, an edge does so too.
std::string SampleWatch::stopped() const {
  if (shared_places_) return {};
  uint32_t first = 0, last = spp_;  // images of one colour at either end say nothing of pixels
  while (first < spp_ && one_value(first))
    ++first;
  while (last > first && one_value(last - 1))
    --last;
  const uint32_t long_tail = spp_ - last + kLeastRun, long_head = first + kLeastRun;
  uint32_t tails = 0, heads = 0, varying = 0;
  for (const Course& course : courses_) {
    if (course.head == 0) continue;
    ++varying;
    if (course.equal_between) continue;
    tails += course.head == 1 && course.run >= long_tail && course.run + kLeastRun <= spp_;
    heads += course.run == 1 && course.head >= long_head && course.head + kLeastRun <= spp_;
  }
  if (tails < std::max(kLeastStopped, varying / 20) || tails < 16 * heads) return {};
  return fmt::format(
      "{} of {} pixels stop changing before the last image: their numbers of samples "
      "were adaptive",
      tails, varying);
}

// Pixels whose samples begin again, at a place of their own, against those where the first two come
// back in the other order.
std::string SampleWatch::begun_again() const {
  uint32_t forward = 0, backward = 0, varying = 0;
  for (const Course& course : courses_) {
    varying += course.head != 0;
    forward += course.forward > 0;
    backward += course.backward > 0;
  }
  if (forward < std::max(kLeastStopped, varying / 20) || forward < 16 * backward) return {};
  return fmt::format("the samples of {} of {} pixels begin again: their numbers were adaptive",
                     forward, varying);
}

std::string SampleWatch::objection() const {
  if (spp_ < 2 || courses_.empty()) return {};
  for (std::string found :
       {stopped(), repeated(), begun_again(), running_mean(), trend(), moving_mean()})
    if (!found.empty()) return found;
  return {};
}

}  // namespace spool::format
