// `spool reconstruct`: the statistics of a selection become an image.
#pragma once

#include <filesystem>
#include <functional>
#include <optional>
#include <string>

#include "lib/core/view.h"
#include "lib/filters/filter.h"
#include "lib/pool/sample_pool.h"
#include "tools/methods/method_settings.h"
#include "tools/methods/selection_file.h"
#include "tools/terminal/console.h"
#include "tools/verbs/replay.h"

namespace spool::tools {

struct ReconstructOptions {
  std::filesystem::path dump;
  std::filesystem::path selection;  // empty: the first `spp` samples of every pixel
  int spp = 0;                      // 0: all
  std::string filter;
  MethodOptions method;
  PoolOptions pool;     // for selections that do not say theirs
  bool layers = false;  // also variance, filter size and direction
  std::string views;    // "f,d.2": intermediate images
  std::filesystem::path output;
  std::filesystem::path pictures;  // folder; empty: none
  bool variance = true;            // of the image; false: not made where the filter can do without
};

Result<void> validate(const ReconstructOptions& options);

Result<void> run_reconstruct(const ReconstructOptions& options, const CommonOptions& common);

struct Reconstructed {
  SamplePool pool;
  Selection selection;
  Reconstruction made;
  Views views;  // those asked for, of the filter, the selection and the image
  GuardCounts guards;
  double seconds = 0.0;
};

// The reconstruction itself; nothing is read but through `load`, and nothing written. Without a
// selection the first `options.spp` samples of every pixel; options.selection is its name in
// errors.
Result<Reconstructed> reconstruct(const ReconstructOptions& options,
                                  const std::optional<SelectionFile>& selection,
                                  const LoadRecording& load,
                                  const std::function<void(double)>& progress);

}  // namespace spool::tools
