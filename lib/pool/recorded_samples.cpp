#include "lib/pool/recorded_samples.h"

#include "lib/core/counted.h"
#include "lib/pool/scan_block.h"

namespace spool {

namespace {

BlockReader reader_of(std::vector<const float*> blocks, std::shared_ptr<const void> storage) {
  return [blocks = std::move(blocks), storage = std::move(storage)](std::size_t i) {
    return Result<BlockValues>(BlockValues{blocks[i], nullptr});
  };
}

}  // namespace

Result<RecordedSamples> RecordedSamples::create(std::string name, LayerBlocks radiance, bool keep,
                                                const SanitiseRules& rules, FirstPass* pass) {
  RecordedSamples samples;
  samples.name_ = std::move(name);
  samples.radiance_ = std::move(radiance);
  samples.rules_ = rules;
  SPOOL_TRY(samples.scan(keep, pass));
  return samples;
}

Result<RecordedSamples> RecordedSamples::create(std::string name, RadianceLayout layout,
                                                const std::shared_ptr<const void>& storage,
                                                const SanitiseRules& rules) {
  SPOOL_CHECK_EQ(layout.blocks.size(), layout.grid.count());
  LayerBlocks blocks(layout.grid, 3, reader_of(std::move(layout.blocks), storage));
  return create(std::move(name), std::move(blocks), false, rules);
}

Result<RecordedSamples> RecordedSamples::from_memory(std::string name, int width, int height,
                                                     int spp, std::vector<float> radiance,
                                                     const SanitiseRules& rules) {
  SPOOL_CHECK_EQ(radiance.size(), static_cast<std::size_t>(3) * width * height * spp);
  auto storage = std::make_shared<const std::vector<float>>(std::move(radiance));
  RadianceLayout layout{{width, height, spp, std::max(width, height), spp}, {storage->data()}};
  return create(std::move(name), std::move(layout), storage, rules);
}

void RecordedSamples::set_pass_film(std::vector<FilmPosition> positions) {
  SPOOL_CHECK_EQ(positions.size(), static_cast<std::size_t>(spp()));
  pass_film_ = std::move(positions);
}

void RecordedSamples::set_sample_film(const std::vector<FilmPosition>& positions) {
  SPOOL_CHECK_EQ(positions.size(), static_cast<std::size_t>(width()) * height() * spp());
  auto channels = std::make_shared<std::vector<float>>();
  channels->reserve(2 * positions.size());
  for (const FilmPosition& position : positions)
    channels->push_back(position.x);
  for (const FilmPosition& position : positions)
    channels->push_back(position.y);
  const LayerGrid whole{width(), height(), spp(), std::max(width(), height()), spp()};
  LayerBlocks film(whole, 2, reader_of({channels->data()}, channels));
  SPOOL_CHECK(
      film.read_all({.keep = true}, [](const BlockView&) { return Result<void>(); }).has_value());
  sample_film_ = std::move(film);
}

FilmPosition RecordedSamples::film(int x, int y, int s) const {
  if (!pass_film_.empty()) return pass_film_[static_cast<std::size_t>(s)];
  if (!sample_film_) return {};
  const LayerBlocks::Place place = sample_film_->place_of(x, y, s);
  return {place.value[0], place.value[place.channel]};
}

Result<void> RecordedSamples::failure() const {
  SPOOL_TRY(radiance_.failure());
  return sample_film_ ? sample_film_->failure() : Result<void>();
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

// Each block when it is read, so that a recording larger than memory is read once.
Result<void> RecordedSamples::scan(bool keep, FirstPass* pass) {
  std::vector<SanitiseReport> blocks(radiance_.grid().count());
  std::vector<std::uint8_t> odd(blocks.size(), 0);  // blocks that a closer look is taken at
  if (pass != nullptr) pass->begin(radiance_.grid());
  const auto see = [&](const BlockRow& row) {
    if (!is_plain_row(row, rules_)) odd[row.block->index] = 1;
    if (pass != nullptr) pass->see(row);
  };
  const LayerBlocks::Reading reading{keep, see, pass != nullptr,
                                     pass == nullptr ? Again::kExpected : Again::kNotExpected};
  SPOOL_TRY(radiance_.read_all(reading, [&](const BlockView& block) {
    if (odd[block.index] != 0) blocks[block.index] = scan_block(block, rules_);
    return Result<void>();
  }));
  for (const SanitiseReport& block : blocks)
    report_.add(block);
  report_.samples = static_cast<std::uint64_t>(width()) * height() * spp();
  any_rejected_ = report_.nonfinite > 0 && rules_.nonfinite == NonFiniteRule::kReject;
  if (report_.nonfinite > 0) report_.empty_pixels = count_empty_pixels(radiance_, blocks);
  return judge_scan();
}

Result<void> RecordedSamples::judge_scan() const {
  if (report_.nonfinite == 0) return {};
  const auto where = fmt::format("first at pixel {},{} sample {}", report_.first_x, report_.first_y,
                                 report_.first_sample);
  if (rules_.nonfinite == NonFiniteRule::kError) {
    return fail(ErrorCode::kData,
                "{}: not finite or above 1e15: {} of {} samples ({}): leave them out "
                "with --set pool.nonfinite=reject, or record them again",
                name_, report_.nonfinite, report_.samples, where);
  }
  if (!any_rejected_ || rules_.allow_many_rejected) return {};
  if (static_cast<double>(report_.nonfinite) >
      kNonFiniteError * static_cast<double>(report_.samples)) {
    return fail(ErrorCode::kData,
                "{}: not finite or above 1e15: {} of {} samples ({}), more than 1 %: "
                "record them again, or go on with --set pool.allow_many_rejected=on",
                name_, report_.nonfinite, report_.samples, where);
  }
  if (report_.empty_pixels > 0) {
    return fail(ErrorCode::kData,
                "{}: {} no finite sample ({}): record them again, or go on with --set "
                "pool.allow_many_rejected=on",
                name_, counted(report_.empty_pixels, "pixel keeps", "pixels keep"), where);
  }
  return {};
}

}  // namespace spool
