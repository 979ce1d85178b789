// All samples of one recording: radiance [c][y][x][s] in tiles and blocks, with optional film
// positions, an optional independent reference, and which samples were rejected.
//
// The values stay where they are (a mapped file, or memory); this class only knows where to look.
// It is immutable once made, so any number of threads and pools may read it.
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "lib/core/error.h"
#include "lib/core/image.h"
#include "lib/pool/sanitise.h"

namespace spool {

// The mean of independent samples of every pixel and the variance of that mean, scene-linear RGB.
struct Reference {
  RgbImage mean;
  std::optional<RgbImage> variance_of_mean;
};

// Film position of a sample inside its pixel, [0, 1)^2, y down.
struct FilmPosition {
  float x = 0.5f, y = 0.5f;
};

// Where the radiance of a recording lies: tile t covers tile_size^2 pixels (cropped at the right
// and bottom), its block b holds samples [b * block_spp, ...) as [c][y][x][s] floats.
struct RadianceLayout {
  int width = 0, height = 0, spp = 0;
  int tile_size = 0;                 // pixels
  int block_spp = 0;                 // samples
  std::vector<const float*> blocks;  // [tile][block]
};

// A layer of features with a value per sample: "albedo", "normal", "depth".
struct FeatureLayer {
  std::string name;
  std::string components;  // "RGB", "XYZ", "Z": one letter per channel
};

// The values [c][y][x][s] of a layer in a rectangle of pixels, its first samples; from any thread.
using FeatureReader = std::function<Result<std::vector<float>>(
    const FeatureLayer&, const Rectangle& pixels, int samples)>;

class RecordedSamples {
 public:
  // `storage` keeps alive whatever the block pointers point into. Scans every sample once (in
  // parallel) to apply `rules`. Errors: kData when non-finite samples are forbidden or too many, or
  // when a pixel keeps no sample, unless the rules allow it.
  static Result<RecordedSamples> create(std::string name, RadianceLayout layout,
                                        std::shared_ptr<const void> storage,
                                        const SanitiseRules& rules = {});

  // A recording in memory: radiance [c][y][x][s]. For synthetic scenes and tests.
  static Result<RecordedSamples> from_memory(std::string name, int width, int height, int spp,
                                             std::vector<float> radiance,
                                             const SanitiseRules& rules = {});

  // Film positions [s] shared by all pixels, or [y][x][s] of each sample.
  void set_pass_film(std::vector<FilmPosition> positions);
  void set_sample_film(std::vector<FilmPosition> positions);
  // Features are read when a method asks for them, and only then.
  void set_features(std::vector<FeatureLayer> layers, FeatureReader reader) {
    features_ = std::move(layers);
    read_feature_ = std::move(reader);
  }
  void set_reference(Reference reference) { reference_ = std::move(reference); }
  // True when s^2/n is the variance of the mean: independent samples, any prefix exchangeable.
  void set_exchangeable(bool exchangeable) { exchangeable_ = exchangeable; }
  void set_cost_per_sample(double seconds) { cost_per_sample_ = seconds; }

  const std::string& name() const { return name_; }
  int width() const { return layout_.width; }
  int height() const { return layout_.height; }
  int spp() const { return layout_.spp; }
  bool exchangeable() const { return exchangeable_; }
  std::optional<double> cost_per_sample() const { return cost_per_sample_; }  // seconds
  const std::optional<Reference>& reference() const { return reference_; }
  const std::vector<FeatureLayer>& features() const { return features_; }
  Result<std::vector<float>> read_feature(const FeatureLayer& layer, const Rectangle& pixels,
                                          int samples) const {
    return read_feature_(layer, pixels, samples);
  }
  const SanitiseReport& report() const { return report_; }
  GuardCounts guards() const;

  bool has_film() const { return !pass_film_.empty() || !sample_film_.empty(); }
  FilmPosition film(int x, int y, int s) const;

  // Sample s (0 .. spp-1, recorded order) of pixel (x, y), after the rules.
  Rgb radiance(int x, int y, int s) const {
    const Rgb value = raw_radiance(x, y, s);
    return rules_.changes_values() ? sanitised(value, rules_) : value;
  }
  Rgb raw_radiance(int x, int y, int s) const {
    const Place place = place_of(x, y, s);
    return {place.red[0], place.red[place.channel], place.red[2 * place.channel]};
  }
  bool any_rejected() const { return any_rejected_; }
  bool rejected(int x, int y, int s) const {
    return any_rejected_ && !is_ordinary(raw_radiance(x, y, s));
  }

 private:
  // Where the red of a sample lies; `channel` floats further green, and blue after as many again.
  struct Place {
    const float* red;
    std::size_t channel;
  };
  Place place_of(int x, int y, int s) const;
  Result<void> scan();
  SanitiseReport scan_tile(int tx, int ty) const;

  std::string name_;
  RadianceLayout layout_;
  int tiles_x_ = 0;
  int blocks_ = 0;
  std::shared_ptr<const void> storage_;
  SanitiseRules rules_;
  SanitiseReport report_;
  bool any_rejected_ = false;
  bool exchangeable_ = true;
  std::optional<double> cost_per_sample_;
  std::optional<Reference> reference_;
  std::vector<FeatureLayer> features_;
  FeatureReader read_feature_;
  std::vector<FilmPosition> pass_film_;
  std::vector<FilmPosition> sample_film_;
};

inline RecordedSamples::Place RecordedSamples::place_of(int x, int y, int s) const {
  const int tile_size = layout_.tile_size;
  const int tx = x / tile_size, ty = y / tile_size, b = s / layout_.block_spp;
  const int tile_width = std::min(tile_size, layout_.width - tx * tile_size);
  const int tile_height = std::min(tile_size, layout_.height - ty * tile_size);
  const int count = std::min(layout_.block_spp, layout_.spp - b * layout_.block_spp);
  const float* block = layout_.blocks[(static_cast<std::size_t>(ty) * tiles_x_ + tx) * blocks_ + b];
  const std::size_t pixel =
      static_cast<std::size_t>(y - ty * tile_size) * tile_width + (x - tx * tile_size);
  return {block + pixel * count + (s - b * layout_.block_spp),
          static_cast<std::size_t>(tile_width) * tile_height * count};
}

}  // namespace spool
