#include "tools/methods/replicate_images.h"

#include <algorithm>
#include <array>
#include <cctype>
#include <memory>
#include <span>
#include <utility>

#include "formats/crc32.h"
#include "lib/filters/given_image.h"
#include "lib/image_io/foreign_picture.h"

namespace spool::tools {
namespace {

constexpr const char* kReplicate = "{replicate}";
constexpr std::array<const char*, 4> kNames = {"{recording}", "{sampler}", "{spp}", kReplicate};

// Of a file name, which may have 255 bytes with its ending.
constexpr std::size_t kLongestPart = 100;

std::string replaced(std::string text, std::string_view name, const std::string& value) {
  for (std::size_t at = text.find(name); at != std::string::npos;
       at = text.find(name, at + value.size()))
    text.replace(at, name.size(), value);
  return text;
}

}  // namespace

NeededSize size_of(const SamplePool& pool) {
  return {pool.recording().width(), pool.recording().height()};
}

bool is_of_replicates(const MethodChoice& filter) {
  return filter.name == "image" && std::ranges::any_of(kNames, [&](const char* name) {
           return filter.preset.find(name) != std::string::npos;
         });
}

// Labels hold ':' and '{', which file names should not. tools/report/file_names.py does the same.
std::string file_name_of(const std::string& label) {
  std::string name = label;
  for (char& c : name) {
    if (std::isalnum(static_cast<unsigned char>(c)) == 0 && c != '.' && c != '-') c = '_';
  }
  while (name.ends_with('_'))
    name.pop_back();
  if (name.size() <= kLongestPart) return name;
  return fmt::format("{}-{:08x}", name.substr(0, kLongestPart - 9),
                     format::crc32(std::as_bytes(std::span(name))));
}

std::string fill_names(std::string pattern, const Cell& cell) {
  pattern = replaced(std::move(pattern), "{recording}",
                     file_name_of(std::filesystem::path(cell.dump).stem().string()));
  pattern = replaced(std::move(pattern), "{sampler}", file_name_of(cell.sampler.label()));
  return replaced(std::move(pattern), "{spp}", fmt::format("{:g}", cell.spp));
}

std::string fill_replicate(std::string pattern, const std::string& replicate) {
  return replaced(std::move(pattern), kReplicate, replicate);
}

std::string image_of(const Cell& cell, const std::string& pattern) {
  return fill_replicate(fill_names(pattern, cell), std::to_string(cell.replicate));
}

Cell with_filled_names(const Cell& cell) {
  if (!is_of_replicates(cell.filter)) return cell;
  Cell filled = cell;
  filled.filter.preset = fill_names(cell.filter.preset, cell);
  filled.filter.set.emplace_back("replicate", std::to_string(cell.replicate));
  return filled;
}

std::string ImageLetters::next(const SamplePool& pool) {
  return pool.is_half() ? std::string(1, letter_++) : std::string();
}

ReadyFilter replicate_image_filter(const std::string& pattern, const std::string& replicate,
                                   const LayerChoice& layer) {
  return {[=, letters = std::make_shared<ImageLetters>()](
              const Selection&, const SamplePool& pool,
              const FilterContext&) -> Result<Reconstruction> {
            if (replicate.empty()) {
              return fail(ErrorCode::kUsage,
                          "image:{}: names the images of an evaluation: use it in spool evaluate, "
                          "or give the name of one file",
                          pattern);
            }
            const std::string letter = letters->next(pool);
            const std::filesystem::path path = fill_replicate(pattern, replicate + letter);
            std::error_code status;
            if (!std::filesystem::exists(path, status)) {
              return fail(ErrorCode::kIo,
                          "{}: is missing: make it of the input of that name (spool evaluate "
                          "--export-inputs DIR){}",
                          path.string(),
                          letter.empty() ? "" : ", or write halves = false into a plan");
            }
            SPOOL_ASSIGN(ForeignPicture picture, read_picture(path, layer, size_of(pool)));
            return own_image(std::move(picture.rgb), pool, "image:" + path.string());
          },
          Needs{}};
}

}  // namespace spool::tools
