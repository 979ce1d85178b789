// All samples of one recording: radiance [c][y][x][s] in tiles and blocks, with optional film
// positions, an optional independent reference, and which samples were rejected.
//
// The values stay where they are (a file, or memory); this class only knows where to look.
// It is immutable once made, so any number of threads and pools may read it.
#pragma once

#include <algorithm>
#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "lib/core/error.h"
#include "lib/core/image.h"
#include "lib/pool/layer_blocks.h"
#include "lib/pool/sanitise.h"

namespace spool {

// What goes through all samples while a recording is read for the first time, each row of a block
// while the processor's cache holds it: a second pass over the samples costs what reading memory
// costs.
class FirstPass {
 public:
  virtual ~FirstPass() = default;

  // Before the first row.
  virtual void begin(const LayerGrid& grid) = 0;
  // values [x][s] of a channel of row y, of all samples of the block as they were recorded, before
  // any rule. The blocks of a tile in their order, on one thread; tiles in any order, on any.
  virtual void see(const BlockRow& row) = 0;
};

// The mean of independent samples of every pixel and the variance of that mean, scene-linear RGB.
struct Reference {
  RgbImage mean;
  std::optional<RgbImage> variance_of_mean;
};

// Film position of a sample inside its pixel, [0, 1)^2, y down.
struct FilmPosition {
  float x = 0.5f, y = 0.5f;
};

// Where the radiance of a recording lies in memory.
struct RadianceLayout {
  LayerGrid grid;
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
  // Reads and scans every sample once (in parallel) to apply `rules`; `keep`: blocks stay in
  // memory; `pass`, which may be null, gets what is read. Errors: those of the layer; kData when
  // non-finite samples are forbidden or too many, or when a pixel keeps no sample, unless the rules
  // allow it.
  static Result<RecordedSamples> create(std::string name, LayerBlocks radiance, bool keep,
                                        const SanitiseRules& rules = {}, FirstPass* pass = nullptr);
  // The same of what lies in memory. `storage` keeps alive whatever the block pointers point into.
  static Result<RecordedSamples> create(std::string name, RadianceLayout layout,
                                        const std::shared_ptr<const void>& storage,
                                        const SanitiseRules& rules = {});

  // A recording in memory: radiance [c][y][x][s]. For synthetic scenes and tests.
  static Result<RecordedSamples> from_memory(std::string name, int width, int height, int spp,
                                             std::vector<float> radiance,
                                             const SanitiseRules& rules = {});

  // Film positions [s] shared by all pixels, or [y][x][s] of each sample: in memory, or in blocks
  // of the channels X and Y that have been read once.
  void set_pass_film(std::vector<FilmPosition> positions);
  void set_sample_film(const std::vector<FilmPosition>& positions);
  void set_sample_film(LayerBlocks positions) { sample_film_ = std::move(positions); }
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
  int width() const { return radiance_.grid().width; }
  int height() const { return radiance_.grid().height; }
  int spp() const { return radiance_.grid().spp; }
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

  bool has_film() const { return !pass_film_.empty() || sample_film_.has_value(); }
  FilmPosition film(int x, int y, int s) const;

  // Sample s (0 .. spp-1, recorded order) of pixel (x, y), after the rules.
  Rgb radiance(int x, int y, int s) const {
    const Rgb value = raw_radiance(x, y, s);
    return rules_.changes_values() ? sanitised(value, rules_) : value;
  }
  Rgb raw_radiance(int x, int y, int s) const {
    const LayerBlocks::Place place = radiance_.place_of(x, y, s);
    return {place.value[0], place.value[place.channel], place.value[2 * place.channel]};
  }
  // The radiance as it lies, before the rules; for code that reads many samples.
  const LayerBlocks& blocks() const { return radiance_; }
  // Whether the rules leave every sample as it lies, and reject none.
  bool as_it_lies() const { return !any_rejected_ && !rules_.changes_values(); }
  bool any_rejected() const { return any_rejected_; }
  bool rejected(int x, int y, int s) const {
    return any_rejected_ && !is_ordinary(raw_radiance(x, y, s));
  }
  // The first error of blocks that were read again and could not be: they held zeros.
  Result<void> failure() const;

 private:
  Result<void> scan(bool keep, FirstPass* pass);
  Result<void> judge_scan() const;

  std::string name_;
  LayerBlocks radiance_;
  SanitiseRules rules_;
  SanitiseReport report_;
  bool any_rejected_ = false;
  bool exchangeable_ = true;
  std::optional<double> cost_per_sample_;
  std::optional<Reference> reference_;
  std::vector<FeatureLayer> features_;
  FeatureReader read_feature_;
  std::vector<FilmPosition> pass_film_;
  std::optional<LayerBlocks> sample_film_;  // channels X, Y
};

}  // namespace spool
