// Prints one hash for the result of every sampler, filter and metric on fixed worlds. Two builds
// that print the same lines gave the same bits: tools/dev.sh bits compares compilers, build types
// and vector widths.
#include <cstring>

#include <fmt/core.h>

#include "lib/directions/directional_filter_bank.h"
#include "lib/metrics/error_metrics.h"
#include "lib/pyramid/laplacian_pyramid.h"
#include "lib/sampling/spending.h"
#include "tests/hard_cases/moved_world.h"
#include "tests/support/every_method.h"

namespace spool {
namespace {

// FNV-1a over the bytes.
class Hash {
 public:
  template <class T>
  void add(const T& value) {
    unsigned char bytes[sizeof(T)];
    std::memcpy(bytes, &value, sizeof(T));
    for (const unsigned char byte : bytes)
      state_ = (state_ ^ byte) * 0x100000001b3u;
  }
  template <class T>
  void add_image(const Image<T>& image) {
    for (const T& value : image.pixels())
      add(value);
  }
  void add_image(const RgbImage& image) {
    for (const Plane& plane : image)
      add_image(plane);
  }
  std::uint64_t state() const { return state_; }

 private:
  std::uint64_t state_ = 0xcbf29ce484222325u;
};

void print(const std::string& name, const Hash& hash) {
  fmt::print("{:016x} {}\n", hash.state(), name);
}

void print_methods(const test::World& world, const std::string& where) {
  const SamplePool pool = test::record(world);
  const Reference reference = test::mean_of_everything(pool);
  const auto filters = test::every_filter(false);
  for (const auto& sampler : test::every_sampler(false)) {
    const auto sampled =
        sampler.run(pool, sample_budget(4, pool.recording()), test::sampling_context());
    SPOOL_CHECK(sampled.has_value());
    const Selection& selection = sampled->selection;
    Hash hash;
    hash.add_image(selection.statistics.n);
    hash.add_image(selection.statistics.m2);
    hash.add_image(selection.statistics.analysis.mean);
    for (const Plane& a : selection.attenuation)
      hash.add_image(a);
    print(fmt::format("{} sampler {}", where, sampler.label()), hash);
    if (sampler.name != "uniform" && sampler.name != "multiscale") continue;
    for (const auto& filter : filters) {
      FilterContext context;
      context.reference = &reference;
      const auto result = filter.run(selection, pool, context);
      SPOOL_CHECK(result.has_value());
      Hash of_image;
      of_image.add_image(result->image);
      if (result->variance) of_image.add_image(*result->variance);
      print(fmt::format("{} filter {} after {}", where, filter.label(), sampler.label()), of_image);
      MetricOptions options;
      options.perceptual = Perceptual::kAll;
      const MetricTable table = error_metrics(result->image, {reference.mean, {}, {}}, options);
      Hash of_metrics;
      for (const MetricValue& value : table.values) {
        of_metrics.add(std::isnan(value.value) ? -1.0 : value.value);
        of_metrics.add(std::isnan(value.standard_error) ? -1.0 : value.standard_error);
      }
      print(fmt::format("{} metrics of {} after {}", where, filter.label(), sampler.label()),
            of_metrics);
    }
  }
}

void print_transforms() {
  Plane image(61, 47);
  for (std::size_t p = 0; p < image.size(); ++p)
    image[p] = test::uniform(3, p);
  for (const WaveletFilter filter :
       {WaveletFilter::kHaar, WaveletFilter::k53, WaveletFilter::k97, WaveletFilter::kDb3}) {
    PyramidOptions options;
    options.filter = filter;
    const Pyramid pyramid = build_pyramid(image, options);
    Hash hash;
    for (const Plane& f : pyramid.coarse)
      hash.add_image(f);
    for (const Plane& d : pyramid.detail)
      hash.add_image(d);
    print(fmt::format("pyramid {}", static_cast<int>(filter)), hash);
  }
  for (const int levels : {1, 2, 3}) {
    BankOptions options;
    options.levels = levels;
    Hash hash;
    for (const Plane& band : directional_bands(image, options))
      hash.add_image(band);
    print(fmt::format("bank {}", levels), hash);
  }
}

}  // namespace
}  // namespace spool

int main() {
  spool::print_transforms();
  spool::print_methods(spool::test::any_world(48, 37, 16, 1), "48x37");
  spool::print_methods(spool::test::scaled(spool::test::any_world(31, 33, 16, 2), 1e6f), "31x33");
}
