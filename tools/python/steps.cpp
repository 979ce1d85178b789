#include "tools/python/steps.h"

#include <nanobind/stl/filesystem.h>
#include <nanobind/stl/optional.h>
#include <nanobind/stl/string.h>
#include <nanobind/stl/tuple.h>
#include <nanobind/stl/vector.h>

#include <algorithm>

#include "formats/record_layout.h"
#include "lib/core/guards.h"
#include "tools/python/arrays.h"
#include "tools/python/running.h"
#include "tools/python/source.h"
#include "tools/verbs/metrics.h"
#include "tools/verbs/reconstruct.h"
#include "tools/verbs/replay.h"
#include "tools/verbs/synth.h"

namespace spool::python {
namespace {

using tools::Reconstructed;
using tools::Replayed;

PoolOptions pool_options(bool shuffled, std::int64_t seed, int holdout, int pieces) {
  PoolOptions pool;
  pool.pieces_per_side = pieces;
  pool.order = shuffled ? PoolOrder::kShuffled : PoolOrder::kRecorded;
  pool.seed = static_cast<std::uint64_t>(seed);
  pool.holdout = holdout;
  return pool;
}

tools::LoadRecording loader(Source& source) {
  return [&source](const SanitiseRules& rules, const WorkingMemory& work, SampleFilm film,
                   FirstPass*) { return source.load(rules, work, film); };
}

nb::dict views_of(const Views& views) {
  nb::dict images;
  for (const View& view : views.collected())
    images[nb::str(view.name.c_str())] = plane_to_numpy(view.image);
  return images;
}

nb::dict guards_of(const GuardCounts& counts) {
  nb::dict guards;
  for (std::size_t g = 0; g < kGuardCount; ++g) {
    const auto guard = static_cast<Guard>(g);
    if (counts[guard] > 0) guards[nb::str(std::string(guard_name(guard)).c_str())] = counts[guard];
  }
  return guards;
}

Replayed replayed(Source& source, const std::string& sampler, double spp, const std::string& filter,
                  const std::string& preset, const std::vector<std::string>& settings,
                  bool shuffled, std::int64_t seed, int holdout, int pieces, bool decision_split,
                  const std::string& views, int threads) {
  tools::ReplayOptions options;
  options.dump = source.name();
  options.sampler = sampler;
  options.filter = filter;
  options.spp = spp;
  options.method = {preset, settings};
  options.pool = pool_options(shuffled, seed, holdout, pieces);
  options.decision_split = decision_split;
  options.views = views;
  return run<Replayed>(
      [&](Watch& watch) {
        return tools::replay(options, loader(source), [&](double share) { watch.update(share); });
      },
      nb::none(), threads);
}

nb::dict log_of(const Replayed& done) {
  const SamplingLog& log = done.sampled.log;
  nb::dict said;
  said["budget"] = log.budget;
  said["initial"] = log.initial;
  said["spent"] = log.spent;
  said["uniform_remainder"] = log.uniform_remainder;
  said["saturated_pieces"] = log.saturated_pieces;
  said["samples_of_level"] = nb::cast(log.samples_of_level);
  said["guards"] = guards_of(done.guards);
  said["seconds"] = done.seconds;
  return said;
}

// The mean of the samples taken, empty pixels filled as every filter does.
nb::object image_of(const Replayed& done) {
  GuardCounts guards;
  return rgb_to_numpy(pixel_means(done.sampled.selection.statistics, guards));
}

Reconstructed reconstructed(Source& source, const std::string& filter, const Replayed* selection,
                            const std::optional<CountArray>& counts, int spp,
                            const std::string& preset, const std::vector<std::string>& settings,
                            bool shuffled, std::int64_t seed, int holdout, int pieces,
                            const std::string& views, int threads) {
  tools::ReconstructOptions options;
  options.dump = source.name();
  options.selection = "selection";
  options.spp = spp;
  options.filter = filter;
  options.method = {preset, settings};
  options.pool = pool_options(shuffled, seed, holdout, pieces);
  options.views = views;
  std::optional<tools::SelectionFile> chosen;
  if (selection != nullptr) {
    chosen = tools::contents_of(selection->sampled.selection, selection->pool.options());
  } else if (counts) {
    if (const auto size = check_image_size(counts->shape(1), counts->shape(0), "selection"); !size)
      raise(size.error());
    Result<CountImage> n = counts_from_numpy(*counts, "selection");
    if (!n) raise(n.error());
    chosen = tools::SelectionFile{std::move(*n), {}, {}, {}};
  }
  return run<Reconstructed>(
      [&](Watch& watch) {
        return tools::reconstruct(options, chosen, loader(source),
                                  [&](double share) { watch.update(share); });
      },
      nb::none(), threads);
}

nb::object variance_of(const Reconstructed& done) {
  return done.made.variance ? rgb_to_numpy(*done.made.variance) : nb::none();
}

Result<void> check_images(const ImageArray& image, const ImageArray& reference) {
  SPOOL_TRY(check_image_size(image.shape(1), image.shape(0), "image"));
  return check_image_size(reference.shape(1), reference.shape(0), "reference");
}

nb::dict judged(const ImageArray& image, const ImageArray& reference,
                const std::optional<ImageArray>& variance, const std::vector<std::string>& settings,
                const std::vector<std::string>& wanted, int threads) {
  if (const auto sizes = check_images(image, reference); !sizes) raise(sizes.error());
  const RgbImage estimate = rgb_from_numpy(image);
  JudgingReference judge;
  judge.mean = rgb_from_numpy(reference);
  if (variance) judge.variance = rgb_from_numpy(*variance);
  const MetricTable table = run<MetricTable>(
      [&](Watch&) -> Result<MetricTable> {
        SPOOL_ASSIGN(MetricOptions options, tools::metric_settings(settings));
        SPOOL_ASSIGN(options.wanted, metrics_named(wanted));
        options.support = false;
        SPOOL_TRY(tools::check_same_size(estimate, judge.mean, "image"));
        if (judge.variance) {
          SPOOL_TRY(tools::check_same_size(*judge.variance, judge.mean, "variance"));
        }
        MetricTable made = error_metrics(estimate, judge, options);
        SPOOL_TRY(tools::check_finite(made, "image", "reference"));
        return made;
      },
      nb::none(), threads);
  nb::dict values;
  for (std::size_t m = 0; m < metrics().size(); ++m) {
    if (!wanted.empty() && std::ranges::find(wanted, metrics()[m].name) == wanted.end()) continue;
    values[nb::str(metrics()[m].name.c_str())] =
        nb::make_tuple(table.values[m].value, table.values[m].standard_error);
  }
  return values;
}

void synthesise(const std::string& scene, int width, int height, int spp, std::int64_t seed,
                const std::string& path, const std::vector<std::string>& settings, bool compress,
                bool force) {
  tools::SynthOptions options;
  options.scene = scene;
  options.size = fmt::format("{}x{}", width, height);
  options.spp = spp;
  options.seed = static_cast<std::uint64_t>(seed);
  options.settings = settings;
  options.compress = compress;
  options.output = path;
  run_watched(
      [&](Watch& watch) {
        return tools::synthesise(options, force, [&](double share) { watch.update(share); });
      },
      nb::none(), 0);
}

Reference reference_of(const ImageArray& mean, const std::optional<ImageArray>& variance) {
  Reference reference{rgb_from_numpy(mean), {}};
  if (variance) reference.variance_of_mean = rgb_from_numpy(*variance);
  return reference;
}

using NamedArray = std::tuple<std::string, std::string, SampleArray>;

// Of radiance, or of another layer of its samples with so many channels.
Result<void> check_layer(const SampleArray& layer, const SampleArray& radiance,
                         std::size_t channels, const std::string& name) {
  SPOOL_TRY(check_image_size(layer.shape(2), layer.shape(1), name));
  const std::size_t spp = layer.shape(3);
  bool fits = layer.shape(0) == channels && spp > 0 && spp <= format::kMaxSpp;
  for (std::size_t d = 1; d < 4; ++d)
    fits = fits && layer.shape(d) == radiance.shape(d);
  if (fits) return {};
  return fail(ErrorCode::kUsage, "{}: {} x {} x {} x {} values [c][y][x][s] are not of one size",
              name, layer.shape(0), layer.shape(1), layer.shape(2), spp);
}

Result<void> check_arrays(const SampleArrays& arrays, const std::string& name) {
  SPOOL_TRY(check_layer(arrays.radiance, arrays.radiance, 3, name + ": radiance"));
  if (arrays.film) SPOOL_TRY(check_layer(*arrays.film, arrays.radiance, 2, name + ": film"));
  for (const auto& [layer, values] : arrays.features) {
    SPOOL_TRY(check_layer(values, arrays.radiance, layer.components.size(),
                          fmt::format("{}: {}", name, layer.name)));
  }
  return {};
}

void make_array_source(Source* place, const std::string& name, const SampleArray& radiance,
                       const std::optional<SampleArray>& film,
                       const std::vector<NamedArray>& features,
                       const std::optional<ImageArray>& reference,
                       const std::optional<ImageArray>& variance, bool exchangeable) {
  SampleArrays arrays{radiance, film, {}, {}, exchangeable};
  for (const auto& [layer, components, values] : features)
    arrays.features.emplace_back(FeatureLayer{layer, components}, values);
  if (const auto sizes = check_arrays(arrays, name); !sizes) raise(sizes.error());
  if (reference) arrays.reference = reference_of(*reference, variance);
  new (place) Source(name, std::move(arrays));
}

// As Python has names of files: they may be no UTF-8.
nb::object name_of(const Source& source) {
  return nb::steal(PyUnicode_DecodeFSDefault(source.name().c_str()));
}

}  // namespace

void bind_source(nb::module_& module) {
  nb::class_<Source>(module, "Source")
      .def("__init__", [](Source* place, const std::filesystem::path& path, std::uint64_t device,
                          std::uint64_t inode) { new (place) Source(path, {device, inode}); })
      .def("__init__", &make_array_source, nb::arg("name"), nb::arg("radiance"),
           nb::arg("film").none(), nb::arg("features"), nb::arg("reference").none(),
           nb::arg("variance").none(), nb::arg("exchangeable"))
      .def_prop_ro("name", &name_of)
      .def("path", [](const Source& source) {
        if (const auto same = source.is_that_file(); !same) raise(same.error());
        return name_of(source);
      });
}

void bind_replay(nb::module_& module) {
  nb::class_<Replayed>(module, "Replayed")
      .def(
          "counts",
          [](const Replayed& done) { return counts_to_numpy(done.sampled.selection.statistics.n); })
      .def("image", &image_of)
      .def("views", [](const Replayed& done) { return views_of(done.views); })
      .def("log", &log_of);
  module.def("replay", &replayed, nb::arg("source"), nb::arg("sampler"), nb::arg("spp"),
             nb::arg("filter"), nb::arg("preset"), nb::arg("settings"), nb::arg("shuffled"),
             nb::arg("seed"), nb::arg("holdout"), nb::arg("pieces"), nb::arg("decision_split"),
             nb::arg("views"), nb::arg("threads"));
}

void bind_reconstruct(nb::module_& module) {
  nb::class_<Reconstructed>(module, "Reconstructed")
      .def("image", [](const Reconstructed& done) { return rgb_to_numpy(done.made.image); })
      .def("variance", &variance_of)
      .def("level",
           [](const Reconstructed& done) -> nb::object {
             return done.made.level ? counts_to_numpy(*done.made.level) : nb::none();
           })
      .def("dominant_direction",
           [](const Reconstructed& done) -> nb::object {
             return done.made.dominant_direction ? plane_to_numpy(*done.made.dominant_direction)
                                                 : nb::none();
           })
      .def("views", [](const Reconstructed& done) { return views_of(done.views); })
      .def("notes", [](const Reconstructed& done) { return done.made.notes; })
      .def("guards", [](const Reconstructed& done) { return guards_of(done.guards); })
      .def("seconds", [](const Reconstructed& done) { return done.seconds; });
  module.def("reconstruct", &reconstructed, nb::arg("source"), nb::arg("filter"),
             nb::arg("selection").none(), nb::arg("counts").none(), nb::arg("spp"),
             nb::arg("preset"), nb::arg("settings"), nb::arg("shuffled"), nb::arg("seed"),
             nb::arg("holdout"), nb::arg("pieces"), nb::arg("views"), nb::arg("threads"));
}

void bind_metrics(nb::module_& module) {
  module.def("metrics", &judged, nb::arg("image"), nb::arg("reference"), nb::arg("variance").none(),
             nb::arg("settings"), nb::arg("wanted"), nb::arg("threads"));
}

void bind_synth(nb::module_& module) {
  module.def("synth", &synthesise, nb::arg("scene"), nb::arg("width"), nb::arg("height"),
             nb::arg("spp"), nb::arg("seed"), nb::arg("path"), nb::arg("settings"),
             nb::arg("compress"), nb::arg("force"));
}

}  // namespace spool::python
