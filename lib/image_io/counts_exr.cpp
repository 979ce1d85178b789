#include "lib/image_io/counts_exr.h"

#include <algorithm>

#include "lib/image_io/exr_layers.h"
#include "lib/image_io/exr_source.h"

namespace spool {
namespace {

Result<std::size_t> counted_part(const ExrSource& source) {
  const std::vector<ExrPart>& parts = source.parts();
  std::vector<std::size_t> with_n;
  std::vector<std::string> names;
  for (std::size_t p = 0; p < parts.size(); ++p) {
    names.push_back(parts[p].name);
    for (const ExrChannel& channel : parts[p].channels)
      if (channel.name == "n") with_n.push_back(p);
  }
  if (parts.size() == 1) return std::size_t{0};
  if (with_n.size() == 1) return with_n[0];
  return fail(ErrorCode::kData, "{}: which of the parts {} holds the counts? Name one channel n",
              source.name(), listed(names));
}

}  // namespace

Result<ExrFile> read_counts_exr(const std::filesystem::path& path,
                                const std::optional<NeededSize>& needed) {
  SPOOL_ASSIGN(ExrSource source, ExrSource::open(path));
  SPOOL_ASSIGN(const std::size_t p, counted_part(source));
  const ExrPart& part = source.parts()[p];
  if (part.flat && part.data != part.display)
    return fail(ErrorCode::kData,
                "{}: the data window ({}) is not the display window ({}): save counts of every "
                "pixel",
                source.name(), text_of(part.data), text_of(part.display));
  if (needed) SPOOL_TRY(check_size(source.name(), part.data, *needed));
  return read_part(source, p);
}

Result<std::size_t> count_channel(const ExrFile& file, const std::string& name) {
  const auto at = [&](std::string_view wanted) {
    const auto found = std::ranges::find(file.channels, wanted, &NamedPlane::name);
    return static_cast<std::size_t>(found - file.channels.begin());
  };
  const std::size_t none = file.channels.size();
  if (at("n") != none) return at("n");
  if (none == 1) return std::size_t{0};
  if (at("Y") != none && at("X") == none && at("Z") == none) return at("Y");
  const auto same = [&](std::size_t a, std::size_t b) {
    return a != none && b != none &&
           std::ranges::equal(file.channels[a].data.pixels(), file.channels[b].data.pixels());
  };
  if (same(at("R"), at("G")) && same(at("R"), at("B"))) return at("R");
  std::vector<std::string> names;
  for (const NamedPlane& channel : file.channels)
    names.push_back(channel.name);
  return fail(ErrorCode::kData, "{}: which channel holds the counts, {}? Name it n", name,
              listed(names));
}

}  // namespace spool
