#include "lib/pool/recorded_samples.h"

#include <algorithm>

#include "lib/core/parallel.h"

namespace spool {

Result<RecordedSamples> RecordedSamples::create(std::string name, RadianceLayout layout,
                                                std::shared_ptr<const void> storage,
                                                const SanitiseRules& rules) {
  SPOOL_CHECK_GT(layout.width, 0);
  SPOOL_CHECK_GT(layout.height, 0);
  SPOOL_CHECK_GT(layout.spp, 0);
  SPOOL_CHECK_GT(layout.tile_size, 0);
  SPOOL_CHECK_GT(layout.block_spp, 0);
  RecordedSamples samples;
  samples.name_ = std::move(name);
  samples.tiles_x_ = (layout.width + layout.tile_size - 1) / layout.tile_size;
  samples.blocks_ = (layout.spp + layout.block_spp - 1) / layout.block_spp;
  const int tiles_y = (layout.height + layout.tile_size - 1) / layout.tile_size;
  SPOOL_CHECK_EQ(layout.blocks.size(),
                 static_cast<std::size_t>(samples.tiles_x_) * tiles_y * samples.blocks_);
  samples.layout_ = std::move(layout);
  samples.storage_ = std::move(storage);
  samples.rules_ = rules;
  SPOOL_TRY(samples.scan());
  return samples;
}

Result<RecordedSamples> RecordedSamples::from_memory(std::string name, int width, int height,
                                                     int spp, std::vector<float> radiance,
                                                     const SanitiseRules& rules) {
  SPOOL_CHECK_EQ(radiance.size(), static_cast<std::size_t>(3) * width * height * spp);
  auto storage = std::make_shared<const std::vector<float>>(std::move(radiance));
  RadianceLayout layout{width, height, spp, std::max(width, height), spp, {storage->data()}};
  return create(std::move(name), std::move(layout), storage, rules);
}

void RecordedSamples::set_pass_film(std::vector<FilmPosition> positions) {
  SPOOL_CHECK_EQ(positions.size(), static_cast<std::size_t>(spp()));
  pass_film_ = std::move(positions);
}

void RecordedSamples::set_sample_film(std::vector<FilmPosition> positions) {
  SPOOL_CHECK_EQ(positions.size(), static_cast<std::size_t>(width()) * height() * spp());
  sample_film_ = std::move(positions);
}

FilmPosition RecordedSamples::film(int x, int y, int s) const {
  if (!pass_film_.empty()) return pass_film_[static_cast<std::size_t>(s)];
  if (sample_film_.empty()) return {};
  return sample_film_[(static_cast<std::size_t>(y) * width() + x) * spp() + s];
}

GuardCounts RecordedSamples::guards() const {
  GuardCounts guards;
  guards.add(rules_.nonfinite == NonFiniteRule::kZero ? Guard::kZeroedNonFinite
                                                      : Guard::kRejectedNonFinite,
             report_.nonfinite);
  if (rules_.negative == NegativeRule::kClampToZero) {
    guards.add(Guard::kClampedNegative, report_.negative);
  }
  guards.add(Guard::kClampedFirefly, report_.fireflies);
  return guards;
}

// Block after block, as they lie in the file: a recording larger than memory is read once.
SanitiseReport RecordedSamples::scan_tile(int tx, int ty) const {
  SanitiseReport report;
  const int size = layout_.tile_size;
  const int x0 = tx * size, x1 = std::min(x0 + size, width());
  const int y0 = ty * size, y1 = std::min(y0 + size, height());
  Image<std::uint8_t> kept(x1 - x0, y1 - y0);
  for (int first = 0; first < spp(); first += layout_.block_spp) {
    const int end = std::min(first + layout_.block_spp, spp());
    for (int y = y0; y < y1; ++y) {
      for (int x = x0; x < x1; ++x) {
        for (int s = first; s < end; ++s) {
          const Rgb value = raw_radiance(x, y, s);
          if (!is_ordinary(value)) {
            report.add_nonfinite(x, y, s);
            continue;
          }
          kept(x - x0, y - y0) = 1;
          if (value[0] < 0 || value[1] < 0 || value[2] < 0) ++report.negative;
          if (std::max({value[0], value[1], value[2]}) > rules_.firefly_limit) ++report.fireflies;
        }
      }
    }
  }
  report.empty_pixels =
      static_cast<std::uint64_t>(std::count(kept.pixels().begin(), kept.pixels().end(), 0));
  return report;
}

Result<void> RecordedSamples::scan() {
  const int tiles_y = (height() + layout_.tile_size - 1) / layout_.tile_size;
  std::vector<SanitiseReport> tiles(static_cast<std::size_t>(tiles_x_) * tiles_y);
  parallel_for(tiles.size(), [&](std::size_t t) {
    tiles[t] = scan_tile(static_cast<int>(t) % tiles_x_, static_cast<int>(t) / tiles_x_);
  });
  for (const SanitiseReport& tile : tiles)
    report_.add(tile);
  report_.samples = static_cast<std::uint64_t>(width()) * height() * spp();
  if (report_.nonfinite == 0) return {};
  any_rejected_ = rules_.nonfinite == NonFiniteRule::kReject;
  const auto where = fmt::format("first at pixel {},{} sample {}", report_.first_x, report_.first_y,
                                 report_.first_sample);
  if (rules_.nonfinite == NonFiniteRule::kError) {
    return fail(ErrorCode::kData,
                "{}: {} of {} samples are not finite ({}): leave them out with --set "
                "pool.nonfinite=reject, or record them again",
                name_, report_.nonfinite, report_.samples, where);
  }
  if (!any_rejected_ || rules_.allow_many_rejected) return {};
  if (static_cast<double>(report_.nonfinite) >
      kNonFiniteError * static_cast<double>(report_.samples)) {
    return fail(ErrorCode::kData,
                "{}: {} of {} samples are not finite ({}), more than 1 %: record them again, or go "
                "on with --set pool.allow_many_rejected=on",
                name_, report_.nonfinite, report_.samples, where);
  }
  if (report_.empty_pixels > 0) {
    return fail(ErrorCode::kData,
                "{}: {} pixels keep no finite sample ({}): record them again, or go on with --set "
                "pool.allow_many_rejected=on",
                name_, report_.empty_pixels, where);
  }
  return {};
}

}  // namespace spool
