#include "tools/reconstruct.h"

#include <algorithm>
#include <chrono>

#include "lib/experiment/decision_split.h"
#include "lib/experiment/reference.h"
#include "lib/image_io/atomic_file.h"
#include "lib/image_io/exr_image.h"
#include "lib/image_io/picture.h"
#include "lib/image_io/png_writer.h"
#include "lib/pool/load_recording.h"
#include "tools/guard_listing.h"
#include "tools/json_text.h"
#include "tools/methods/method_memory.h"
#include "tools/methods/selection_file.h"
#include "tools/methods/view_files.h"
#include "tools/picture_name.h"
#include "tools/progress.h"
#include "tools/result_pictures.h"

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
        return fail(
            ErrorCode::kData,
            "{}: {} samples of a pixel asked for, the pool has {} (pixel {}, {}): use fewer",
            pool.recording().name(), spp, capacity, x, y);
      }
      n(x, y) = spp == 0 ? capacity : std::min(capacity, (spp + q * q - 1) / (q * q));
    }
  }
  return n;
}

struct Input {
  std::shared_ptr<const RecordedSamples> recording;
  SamplePool pool;
  Selection selection;
};

Result<Input> load_input(const ReconstructOptions& options, const SanitiseRules& rules,
                         const WorkingMemory& work, SampleFilm film) {
  if (options.selection.empty()) {
    SPOOL_ASSIGN(const auto recording, load_recording(options.dump, rules, work, film));
    SPOOL_ASSIGN(SamplePool pool, SamplePool::create(recording, options.pool));
    SelectionFile all;
    SPOOL_ASSIGN(all.n, uniform_counts(pool, options.spp));
    SPOOL_ASSIGN(Selection selection, apply_selection(all, options.dump, pool));
    return Input{recording, std::move(pool), std::move(selection)};
  }
  SPOOL_ASSIGN(const SelectionFile file, read_selection(options.selection));
  const PoolOptions pool_options = file.pool.value_or(options.pool);
  if (pool_options.pieces_per_side > 1) film = SampleFilm::kLoad;
  SPOOL_ASSIGN(const auto recording, load_recording(options.dump, rules, work, film));
  SPOOL_ASSIGN(SamplePool pool, SamplePool::create(recording, pool_options));
  SPOOL_ASSIGN(Selection selection, apply_selection(file, options.selection, pool));
  return Input{recording, std::move(pool), std::move(selection)};
}

ExrFile image_file(const Reconstruction& result, bool layers) {
  ExrFile file = exr_from_rgb(result.image);
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
  if (result.level) {
    Plane level(result.level->width(), result.level->height());
    for (std::size_t i = 0; i < level.size(); ++i)
      level[i] = (*result.level)[i];
    add("filter.level", level);
  }
  if (result.dominant_direction) add("filter.angle", *result.dominant_direction);
  return file;
}

// Views with a value per piece do not fit into an image of pixels: NAME_pieces.exr.
Result<void> write_piece_views(const ReconstructOptions& options, const SamplePool& pool,
                               const Views& views, const CommonOptions& common) {
  ExrFile file;
  file.width = pool.width();
  file.height = pool.height();
  add_view_layers(views, file);
  std::filesystem::path path = options.output;
  path.replace_filename(path.stem().string() + "_pieces.exr");
  if (!common.quiet && !common.json) {
    print_line(fmt::format("{}: views of pieces, {} x {}", path.string(), file.width, file.height));
  }
  return write_exr(path, file, {.overwrite = common.force});
}

// For eyes, not for measuring: sRGB, exposed as the pictures of an evaluation are.
Result<void> write_picture(const std::filesystem::path& path, const Input& input,
                           const Reconstruction& result, bool overwrite) {
  const Result<JudgingReference> reference = independent_reference(input.pool.recording());
  const RgbImage& guide = reference ? reference->mean : result.image;
  return write_png(path, tone_map(result.image, tone_exposure(guide)), overwrite);
}

Result<void> write_pictures(const ReconstructOptions& options, const Input& input,
                            const Reconstruction& result, bool overwrite) {
  std::error_code status;
  std::filesystem::create_directories(options.pictures, status);
  const CountImage& counts = input.selection.statistics.n;
  const Result<JudgingReference> reference = independent_reference(input.pool.recording());
  const ResultImages images{fmt::format("{}  {}", options.dump.filename().string(), options.filter),
                            &result, &counts, reference ? &*reference : nullptr};
  const PictureScale scale =
      picture_scale(images.reference, result.image, *std::ranges::max_element(counts.pixels()));
  SPOOL_TRY(write_result_pictures(options.pictures, images, scale, overwrite));
  return write_contact_sheet(options.pictures / "contact_sheet.png", images, scale, overwrite);
}

void say_what_was_made(const ReconstructOptions& options, const Input& input,
                       const Reconstruction& result, double seconds, const CommonOptions& common) {
  const int width = result.image[0].width(), height = result.image[0].height();
  if (common.json) {
    GuardCounts guards = input.pool.recording().guards();
    guards += result.guards;
    print(json_text({{"filter", options.filter},
                     {"output", options.output.string()},
                     {"width", width},
                     {"height", height},
                     {"notes", result.notes},
                     {"guards", guard_listing(guards)},
                     {"seconds", seconds}}));
  } else if (!common.quiet) {
    print_line(fmt::format("{}: {} x {} pixels, {}", options.output.string(), width, height,
                           format_seconds(seconds)));
  }
}

}  // namespace

Result<void> run_reconstruct(const ReconstructOptions& options, const CommonOptions& common) {
  const bool as_picture = is_png_name(options.output);
  if (!as_picture) SPOOL_TRY(check_exr_name(options.output));
  if (as_picture && (options.layers || !options.views.empty())) {
    return fail(ErrorCode::kUsage, "{}: a PNG has no layers: write -o NAME.exr for them",
                options.output.string());
  }
  SPOOL_TRY(refuse_existing(options.output, common.force));
  SPOOL_ASSIGN(const Methods methods, choose_methods({}, {options.filter}, options.method));
  const ReadyFilter filter = average_halves(methods.filters[0].ready);
  const std::vector<std::string> wanted = split_list(options.views);
  std::vector<ViewDescription> known = methods.filters[0].method->views;
  known.insert(known.end(), selection_views().begin(), selection_views().end());
  known.insert(known.end(), image_views().begin(), image_views().end());
  SPOOL_TRY(check_views(wanted, known));
  const int pieces = options.pool.pieces_per_side;
  const WorkingMemory work = filtering_memory(methods.filters[0].choice, pieces);
  const SampleFilm film = film_for({}, choices_of(methods.filters), pieces);
  SPOOL_ASSIGN(const Input input, load_input(options, methods.rules, work, film));
  Progress progress("reconstruct " + options.filter, common.quiet);
  Views views(wanted);
  const auto& reference = input.pool.recording().reference();
  const FilterContext context{&views, reference ? &*reference : nullptr,
                              [&](double share) { progress.update(share); }};
  const auto start = std::chrono::steady_clock::now();
  Result<Reconstruction> filtered = filter(input.selection, input.pool, context);
  SPOOL_TRY(still_intact(input.recording));  // before what a method says about lost samples
  SPOOL_ASSIGN(const Reconstruction result, std::move(filtered));
  const std::chrono::duration<double> seconds = std::chrono::steady_clock::now() - start;
  ExrFile file = image_file(result, options.layers);
  add_selection_views(input.selection, views);
  add_image_views(result, views);
  const bool of_pieces = !add_view_layers(views, file).empty();
  file.text_attributes = {{"spool.filter", options.filter}, {"spool.dump", options.dump.string()}};
  if (as_picture) {
    SPOOL_TRY(write_picture(options.output, input, result, common.force));
  } else {
    SPOOL_TRY(write_exr(options.output, file, {.overwrite = common.force}));
  }
  if (of_pieces) {
    SPOOL_TRY(write_piece_views(options, input.pool, views, common));
  }
  if (!options.pictures.empty()) {
    SPOOL_TRY(write_pictures(options, input, result, common.force));
    SPOOL_TRY(write_view_pictures(views, options.pictures / "views", common.force));
  }
  say_what_was_made(options, input, result, seconds.count(), common);
  return {};
}

}  // namespace spool::tools
