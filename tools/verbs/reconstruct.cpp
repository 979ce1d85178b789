#include "tools/verbs/reconstruct.h"

#include <algorithm>
#include <chrono>

#include "formats/spool_reader.h"
#include "formats/target_watch.h"
#include "lib/core/counted.h"
#include "lib/experiment/decision_split.h"
#include "lib/experiment/reference.h"
#include "lib/image_io/atomic_file.h"
#include "lib/image_io/exr_image.h"
#include "lib/image_io/picture.h"
#include "lib/image_io/png_writer.h"
#include "lib/pool/load_recording.h"
#include "lib/statistics/means_pass.h"
#include "tools/json/answers_json.h"
#include "tools/methods/method_memory.h"
#include "tools/methods/view_files.h"
#include "tools/terminal/progress.h"
#include "tools/verbs/picture_name.h"
#include "tools/verbs/result_pictures.h"

namespace spool::tools {
namespace {

// The first `spp` samples of every pixel, spread evenly over its pieces.
Result<CountImage> uniform_counts(const SamplePool& pool, int spp) {
  const int q = pool.pieces_per_side();
  CountImage n(pool.width(), pool.height());
  for (int y = 0; y < n.height(); ++y) {
    for (int x = 0; x < n.width(); ++x) {
      const int capacity = pool.capacity(x, y);
      if (q == 1 && spp > capacity) {
        return fail(ErrorCode::kData,
                    "{}: {} of a pixel asked for, the recording has {} (pixel {}, {}): use fewer",
                    pool.recording().name(), counted(spp, "sample"), capacity, x, y);
      }
      n(x, y) = spp == 0 ? capacity : std::min(capacity, (spp + q * q - 1) / (q * q));
    }
  }
  return n;
}

// A small file may claim a huge image: apply_selection() looks at what was decoded.
Result<void> check_selection_size(const ReconstructOptions& options) {
  SPOOL_ASSIGN(const format::SpoolReader recording, format::SpoolReader::open(options.dump));
  SPOOL_ASSIGN(const ExrSource source, ExrSource::open(options.selection));
  const auto width = static_cast<double>(recording.header().width),
             height = static_cast<double>(recording.header().height);
  for (const ExrPart& part : source.parts())
    if (static_cast<double>(part.data.width) > width * kPiecesPerSide.highest ||
        static_cast<double>(part.data.height) > height * kPiecesPerSide.highest)
      return fail(ErrorCode::kData,
                  "{}: is {} x {}, the recording {} x {}: a selection has the recording's size",
                  source.name(), part.data.width, part.data.height, width, height);
  return {};
}

// Means do where it is not.
bool variance_is_wanted(const ReconstructOptions& options, const Needs& needs) {
  return options.variance || needs.variance || !options.views.empty();
}

struct Input {
  std::shared_ptr<const RecordedSamples> recording;
  SamplePool pool;
  Selection selection;
};

Result<Input> load_input(const ReconstructOptions& options,
                         const std::optional<SelectionFile>& selection, const Methods& methods,
                         const std::vector<ViewDescription>& known, const Views& views,
                         const LoadRecording& load) {
  const PoolOptions pool_options =
      selection ? selection->pool.value_or(options.pool) : options.pool;
  const int pieces = pool_options.pieces_per_side;
  Demands filter = demands_of(methods.filters[0]);
  const bool means = !variance_is_wanted(options, filter.needs);
  if (means) filter.memory = methods.filters[0].ready.memory_of_means.value_or(filter.memory);
  const WorkingMemory own = filtering_memory(filter, pieces);
  const WorkingMemory work = with_views(own, known, views, pieces);
  MeansPass pass(options.spp, pool_options.holdout);
  const bool one_pass = means && !selection && !filter.needs.pool;
  SPOOL_ASSIGN(const auto recording, load(methods.rules, work, film_for({}, {filter}, pieces),
                                          one_pass ? &pass : nullptr));
  SPOOL_ASSIGN(SamplePool pool, SamplePool::create(recording, pool_options));
  SelectionFile all;
  if (one_pass) {
    if (auto statistics = std::move(pass).taken(pool))
      return Input{
          recording, std::move(pool), {.statistics = std::move(*statistics), .attenuation = {}}};
  }
  if (!selection) {
    SPOOL_ASSIGN(all.n, uniform_counts(pool, options.spp));
  }
  const bool looked_at = methods.filters[0].ready.needs.signal || !options.views.empty();
  SPOOL_ASSIGN(Selection selected,
               apply_selection(selection ? *selection : all,
                               selection ? options.selection : options.dump, pool,
                               means       ? Made::kMeans
                               : looked_at ? Made::kAll
                                           : Made::kWithoutSignal));
  return Input{recording, std::move(pool), std::move(selected)};
}

// Takes the image where it is not used again.
ExrFile image_file(Reconstruction& result, bool layers, bool last) {
  ExrFile file = exr_from_rgb(last ? std::move(result.image) : result.image);
  if (!layers) return file;
  const auto add = [&](std::string name, const Plane& plane) {
    if (plane.width() == file.width && plane.height() == file.height) {
      file.channels.push_back({std::move(name), PixelType::kFloat, plane});
    }
  };
  if (result.variance) {
    for (std::size_t c = 0; c < 3; ++c) {
      add(std::string("variance.") + "RGB"[c], (*result.variance)[c]);
    }
  }
  if (result.level) add("filter.level", as_plane(*result.level));
  if (result.dominant_direction) add("filter.angle", *result.dominant_direction);
  return file;
}

// Views with a value per piece do not fit into an image of pixels: NAME_pieces.exr.
std::filesystem::path piece_file(const ReconstructOptions& options) {
  std::filesystem::path path = options.output;
  return path.replace_filename(path.stem().string() + "_pieces.exr");
}

Result<void> write_piece_views(const ReconstructOptions& options, const SamplePool& pool,
                               const Views& views, const CommonOptions& common) {
  ExrFile file{pool.width(), pool.height(), {}};
  add_view_layers(views, file);
  const std::filesystem::path path = piece_file(options);
  if (!common.quiet && !common.json) {
    print_line(fmt::format("{}: views of pieces, {} x {}", path.string(), file.width, file.height));
  }
  return write_exr(path, file, {.overwrite = common.force});
}

// For eyes, not for measuring: sRGB, exposed as the pictures of an evaluation are.
Result<void> write_picture(const std::filesystem::path& path, const Reconstructed& done,
                           bool overwrite) {
  const Result<JudgingReference> reference = independent_reference(done.pool.recording());
  const RgbImage& guide = reference ? reference->mean : done.made.image;
  return write_png(path, tone_map(done.made.image, tone_exposure(guide)), overwrite);
}

Result<void> write_pictures(const ReconstructOptions& options, const Reconstructed& done,
                            bool overwrite) {
  std::error_code status;
  std::filesystem::create_directories(options.pictures, status);
  const CountImage& counts = done.selection.statistics.n;
  const Result<JudgingReference> reference = independent_reference(done.pool.recording());
  ResultImages images =
      images_of(fmt::format("{}  {}", options.dump.filename().string(), options.filter), done.made,
                counts, reference ? &*reference : nullptr);
  const PictureScale scale =
      picture_scale(images.reference, done.made.image, *std::ranges::max_element(counts.pixels()));
  complete_maps(images, scale.exposure);
  SPOOL_TRY(write_result_numbers(options.pictures, images, {}, {.overwrite = overwrite}));
  SPOOL_TRY(write_result_pictures(options.pictures, images, scale, overwrite));
  return write_contact_sheet(options.pictures / "contact_sheet.png", images, scale, overwrite);
}

void say_what_was_made(const ReconstructOptions& options, const Reconstructed& done, int width,
                       int height, const CommonOptions& common) {
  if (common.json) {
    print(reconstruction_text({options.filter, options.output, done.guards, done.seconds}, width,
                              height, done.made.notes));
  } else if (!common.quiet) {
    print_line(fmt::format("{}: {} x {} pixels, {}", options.output.string(), width, height,
                           format_seconds(done.seconds)));
    for (const std::string& note : done.made.notes)
      print_note(note);
  }
}

Result<void> write_result(const ReconstructOptions& options, Reconstructed& done, bool as_picture,
                          const CommonOptions& common) {
  if (as_picture) {
    SPOOL_TRY(write_picture(options.output, done, common.force));
  }
  ExrFile file = image_file(done.made, options.layers, options.pictures.empty());
  const bool of_pieces = !add_view_layers(done.views, file).empty();
  file.text_attributes = {{"spool.filter", options.filter}, {"spool.dump", options.dump.string()}};
  if (!as_picture) {
    SPOOL_TRY(write_exr(options.output, std::move(file),
                        {.overwrite = common.force, .compression = ExrCompression::kNone}));
  }
  if (of_pieces) {
    SPOOL_TRY(write_piece_views(options, done.pool, done.views, common));
  }
  if (options.pictures.empty()) return {};
  SPOOL_TRY(write_pictures(options, done, common.force));
  return write_view_pictures(done.views, options.pictures / "views", common.force);
}

}  // namespace

Result<void> validate(const ReconstructOptions& options) {
  if (options.spp != 0) SPOOL_TRY(check_bounds("spp", options.spp, kSamples));
  return validate(options.pool);
}

Result<Reconstructed> reconstruct(const ReconstructOptions& options,
                                  const std::optional<SelectionFile>& selection,
                                  const LoadRecording& load,
                                  const std::function<void(double)>& progress) {
  SPOOL_TRY(validate(options));
  SPOOL_ASSIGN(const Methods methods, choose_methods({}, {options.filter}, options.method));
  const ReadyFilter filter = average_halves(methods.filters[0].ready);
  const std::vector<std::string> wanted = split_list(options.views);
  std::vector<ViewDescription> known = methods.filters[0].method->views;
  known.insert(known.end(), selection_views().begin(), selection_views().end());
  known.insert(known.end(), image_views().begin(), image_views().end());
  SPOOL_TRY(check_views(wanted, known));
  Views views(wanted);
  SPOOL_ASSIGN(Input input, load_input(options, selection, methods, known, views, load));
  const auto& reference = input.pool.recording().reference();
  FilterContext context{&views, reference ? &*reference : nullptr, progress};
  context.variance = variance_is_wanted(options, filter.needs);
  const auto start = std::chrono::steady_clock::now();
  Result<Reconstruction> filtered = filter(input.selection, input.pool, context);
  SPOOL_TRY(still_intact(input.recording));  // before what a method says about lost samples
  SPOOL_ASSIGN(Reconstruction made, std::move(filtered));
  const std::chrono::duration<double> seconds = std::chrono::steady_clock::now() - start;
  add_selection_views(input.selection, views);
  add_image_views(made, views);
  GuardCounts guards = input.recording->guards();
  guards += made.guards;
  return Reconstructed{
      std::move(input.pool), std::move(input.selection), std::move(made), std::move(views), guards,
      seconds.count()};
}

Result<void> run_reconstruct(const ReconstructOptions& given, const CommonOptions& common) {
  SPOOL_TRY(validate(given));
  ReconstructOptions options = given;
  options.variance = options.layers || common.json || !options.pictures.empty();
  const bool as_picture = is_png_name(options.output);
  if (!as_picture) SPOOL_TRY(check_exr_name(options.output));
  if (as_picture && (options.layers || !options.views.empty())) {
    return fail(ErrorCode::kUsage, "{}: a PNG has no layers: write -o NAME.exr for them",
                options.output.string());
  }
  const std::string given_image = options.filter.substr(options.filter.find(':') + 1);
  for (const std::filesystem::path& input :
       {options.dump, options.selection, std::filesystem::path(given_image)})
    for (const std::filesystem::path& output : {options.output, piece_file(options)})
      SPOOL_TRY(format::refuse_own_input(output, input));
  SPOOL_TRY(refuse_existing(options.output, common.force));
  std::optional<SelectionFile> selection;
  if (!options.selection.empty()) {
    SPOOL_TRY(check_selection_size(options));
    SPOOL_ASSIGN(selection, read_selection(options.selection));
    const int kept = selection->pool.value_or(options.pool).holdout;
    if (options.pool.holdout != 0 && options.pool.holdout != kept)
      return fail(ErrorCode::kUsage, "--holdout {}: {} was made with {}: leave --holdout out",
                  options.pool.holdout, options.selection.string(), kept);
  }
  std::optional<Progress> progress;  // from when the recording is there
  SPOOL_ASSIGN(Reconstructed done,
               reconstruct(
                   options, selection,
                   [&](const SanitiseRules& rules, const WorkingMemory& work, SampleFilm film,
                       FirstPass* pass) {
                     auto recording = load_recording(options.dump, rules, work, film, pass);
                     progress.emplace("reconstruct " + options.filter, common.quiet);
                     return recording;
                   },
                   [&](double share) { progress->update(share); }));
  progress.reset();
  const int width = done.made.image[0].width(), height = done.made.image[0].height();
  SPOOL_TRY(write_result(options, done, as_picture, common));
  say_what_was_made(options, done, width, height, common);
  return {};
}

}  // namespace spool::tools
