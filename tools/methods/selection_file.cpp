#include "tools/methods/selection_file.h"

#include <algorithm>
#include <array>
#include <bit>
#include <charconv>
#include <cmath>
#include <utility>

#include "lib/core/counted.h"
#include "lib/core/guards.h"
#include "lib/image_io/counts_exr.h"
#include "lib/statistics/joined_halves.h"
#include "tools/methods/view_files.h"

namespace spool::tools {
namespace {

constexpr std::array<const char*, 2> kHalves = {"even.", "odd."};
constexpr double kLargestCount = 65536.0;  // samples per pixel of a recording [spool.md 6]

Result<CountImage> counts_of(const NamedPlane& channel, const std::string& name) {
  CountImage n(channel.data.width(), channel.data.height());
  for (int y = 0; y < n.height(); ++y) {
    for (int x = 0; x < n.width(); ++x) {
      const double value = channel.data(x, y);
      // Written so that NaN fails.
      if (!(value >= 0.0 && value <= kLargestCount) || value != std::floor(value)) {
        return fail(ErrorCode::kData,
                    "{}: channel {} holds {}, which is no number of samples (pixel {}, {}): counts "
                    "are whole numbers from 0 to {}",
                    name, channel.name, value, x, y, kLargestCount);
      }
      n(x, y) = static_cast<std::int32_t>(value);
    }
  }
  return n;
}

// Nothing in an image made elsewhere. Of an attribute that a tool changed, the counts would be of
// other samples than those they were decided on.
Result<std::optional<PoolOptions>> pool_options_of(const ExrFile& file, const std::string& name) {
  const auto order = file.text_attributes.find("spool.pool_order");
  const auto seed = file.text_attributes.find("spool.pool_seed");
  const auto holdout = file.number_attributes.find("spool.holdout");
  const auto side = file.number_attributes.find("spool.pieces_per_side");
  if (order == file.text_attributes.end() || seed == file.text_attributes.end() ||
      holdout == file.number_attributes.end() || side == file.number_attributes.end()) {
    return std::nullopt;
  }
  const auto refuse = [&](const auto& attribute) {
    return fail(ErrorCode::kData,
                "{}: attribute {} is '{}', was it edited? Replay the sampler again", name,
                attribute->first, attribute->second);
  };
  PoolOptions options;
  if (order->second == "shuffled") {
    options.order = PoolOrder::kShuffled;
  } else if (order->second != "recorded") {
    return refuse(order);
  }
  const char* end = seed->second.data() + seed->second.size();
  const auto parsed = std::from_chars(seed->second.data(), end, options.seed);
  if (parsed.ec != std::errc() || parsed.ptr != end) return refuse(seed);
  const double held = holdout->second;
  // Written so that NaN fails.
  if (!(held >= 0.0 && held <= kLargestCount) || held != std::floor(held)) return refuse(holdout);
  options.holdout = static_cast<int>(held);
  if (side->second != 1.0 && side->second != 2.0) return refuse(side);
  options.pieces_per_side = static_cast<int>(side->second);
  return options;
}

// `part` is "" or, of a half, "even." or "odd.".
std::optional<AnalysisSignal> signal_of(const ExrFile& file, const std::string& part) {
  const auto exposure = file.number_attributes.find(fmt::format("spool.{}exposure", part));
  if (exposure == file.number_attributes.end() || !std::isfinite(exposure->second) ||
      !(exposure->second > 0.0)) {
    return std::nullopt;
  }
  AnalysisSignal signal;
  signal.exposure = exposure->second;
  const auto says = [&](const char* name, const char* word) {
    const auto attribute = file.text_attributes.find(name);
    return attribute != file.text_attributes.end() && attribute->second == word;
  };
  if (says("spool.analysis_channel", "max_rgb")) signal.channel = AnalysisChannel::kMaxRgb;
  return signal;
}

// Programs before decided on a map of the luminance, or on a clamped one, where they were asked to.
Result<void> refuse_removed_signal(const ExrFile& file, const std::filesystem::path& path) {
  const auto map = file.text_attributes.find("spool.decision_map");
  const auto clamp = file.number_attributes.find("spool.decision_clamp");
  const bool mapped = map != file.text_attributes.end() && map->second != "linear";
  const bool clamped =
      clamp != file.number_attributes.end() && clamp->second > 0.0 && std::isfinite(clamp->second);
  if (!mapped && !clamped) return {};
  return fail(ErrorCode::kData,
              "{}: was decided with {}, an option that is no more: replay the sampler again",
              path.string(), mapped ? "decision_map=" + map->second : "decision_clamp");
}

bool are_floats(const Plane& values) {
  return std::ranges::all_of(values.pixels(), [](double value) {
    return static_cast<double>(static_cast<float>(value)) == value;
  });
}

// A_k for people, and its bits where it is more than a float: rounded it would change the last bits
// of an image.
void add_attenuation(ExrFile& file, const std::string& part, std::size_t level,
                     const Plane& attenuation) {
  if (are_floats(attenuation)) {
    file.channels.push_back({fmt::format("{}A.{}", part, level), PixelType::kFloat, attenuation});
    return;
  }
  Plane high(file.width, file.height), low(file.width, file.height);
  for (std::size_t i = 0; i < attenuation.size(); ++i) {
    const auto bits = std::bit_cast<std::uint64_t>(attenuation[i]);
    high[i] = static_cast<double>(bits >> 32);
    low[i] = static_cast<double>(bits & 0xFFFFFFFFu);
  }
  const auto add = [&](const std::string& name, PixelType type, Plane plane) {
    file.channels.push_back({part + name, type, std::move(plane)});
  };
  add(fmt::format("A.{}", level), PixelType::kFloat, attenuation);
  add(fmt::format("A_bits.{}.high", level), PixelType::kUint, std::move(high));
  add(fmt::format("A_bits.{}.low", level), PixelType::kUint, std::move(low));
}

// The bits, where they are there and round to the value that people see.
Plane exact_attenuation(const ExrFile& file, const std::string& part, std::size_t level,
                        const Plane& shown) {
  const Plane* high = file.find(fmt::format("{}A_bits.{}.high", part, level));
  const Plane* low = file.find(fmt::format("{}A_bits.{}.low", part, level));
  if (high == nullptr || low == nullptr) return shown;
  Plane exact = shown;
  for (std::size_t i = 0; i < exact.size(); ++i) {
    constexpr double kLargest = 4294967295.0;
    if (!((*high)[i] >= 0.0 && (*high)[i] <= kLargest && (*low)[i] >= 0.0 &&
          (*low)[i] <= kLargest)) {
      continue;  // channels of another type than uint
    }
    const auto value = std::bit_cast<double>((static_cast<std::uint64_t>((*high)[i]) << 32) |
                                             static_cast<std::uint64_t>((*low)[i]));
    if (static_cast<float>(value) == static_cast<float>(shown[i])) exact[i] = value;
  }
  return exact;
}

void add_selection(ExrFile& file, const std::string& part, const Selection& selection) {
  const CountImage& n = selection.statistics.n;
  file.channels.push_back({part + "n", PixelType::kUint, as_plane(n)});
  for (std::size_t l = 0; l < selection.attenuation.size(); ++l)
    add_attenuation(file, part, l, selection.attenuation[l]);
  file.number_attributes[fmt::format("spool.{}exposure", part)] =
      selection.statistics.signal.exposure;
}

void read_rest(const ExrFile& file, const std::string& part, SelectionFile& selection) {
  for (std::size_t l = 0; const Plane* layer = file.find(fmt::format("{}A.{}", part, l)); ++l)
    selection.attenuation.push_back(exact_attenuation(file, part, l, *layer));
  selection.signal = signal_of(file, part);
}

}  // namespace

Result<CountImage> counts_from_exr(const ExrFile& file, const std::string& name) {
  SPOOL_ASSIGN(const std::size_t channel, count_channel(file, name));
  return counts_of(file.channels[channel], name);
}

Result<void> write_selection(const std::filesystem::path& path, const Selection& selection,
                             const SelectionInfo& info, bool overwrite, const Views* views) {
  const CountImage& n = selection.statistics.n;
  const AnalysisSignal& signal = selection.statistics.signal;
  ExrFile file{n.width(), n.height(), {}};
  file.number_attributes = {{"spool.holdout", info.pool.holdout},
                            {"spool.pieces_per_side", info.pool.pieces_per_side}};
  add_selection(file, "", selection);
  for (std::size_t h = 0; h < selection.halves.size(); ++h)
    add_selection(file, kHalves[h], selection.halves[h]);
  file.text_attributes = {
      {"spool.sampler", info.sampler},
      {"spool.dump", info.dump},
      {"spool.pool_order", info.pool.order == PoolOrder::kShuffled ? "shuffled" : "recorded"},
      {"spool.pool_seed", std::to_string(info.pool.seed)},
      {"spool.analysis_channel",
       signal.channel == AnalysisChannel::kMaxRgb ? "max_rgb" : "luminance"}};
  if (selection.halves_use == HalvesUse::kTogether) {
    file.text_attributes["spool.halves"] = "together";
  }
  if (views != nullptr) add_view_layers(*views, file);
  return write_exr(path, std::move(file),
                   {.overwrite = overwrite, .compression = ExrCompression::kRunLengths});
}

Result<SelectionFile> read_selection(const std::filesystem::path& path) {
  SPOOL_ASSIGN(const ExrFile file, read_counts_exr(path));
  SPOOL_TRY(refuse_removed_signal(file, path));
  SelectionFile selection;
  SPOOL_ASSIGN(selection.n, counts_from_exr(file, path.string()));
  if (std::ranges::count(selection.n.pixels(), 0) == std::ssize(selection.n.pixels()))
    return fail(ErrorCode::kData, "{}: no piece has a sample: raise the budget or check the counts",
                path.string());
  read_rest(file, "", selection);
  SPOOL_ASSIGN(selection.pool, pool_options_of(file, path.string()));
  for (const char* part : kHalves) {
    const std::string channel = std::string(part) + "n";
    const Plane* counts = file.find(channel);
    if (counts == nullptr) continue;
    SelectionFile half;
    SPOOL_ASSIGN(half.n, counts_of({channel, PixelType::kUint, *counts}, path.string()));
    read_rest(file, part, half);
    selection.halves.push_back(std::move(half));
  }
  if (selection.halves.size() == 1) {
    return fail(ErrorCode::kData,
                "{}: has one of the channels even.n and odd.n: a split decision has both",
                path.string());
  }
  const auto use = file.text_attributes.find("spool.halves");
  if (!selection.halves.empty() && use != file.text_attributes.end() && use->second == "together") {
    selection.halves_use = HalvesUse::kTogether;
  }
  return selection;
}

SelectionFile contents_of(const Selection& selection, const PoolOptions& pool) {
  SelectionFile file{selection.statistics.n, selection.attenuation, selection.statistics.signal,
                     pool};
  for (const Selection& half : selection.halves)
    file.halves.push_back(contents_of(half, pool));
  file.halves_use = selection.halves_use;
  return file;
}

Result<Selection> apply_selection(const SelectionFile& file, const std::filesystem::path& path,
                                  const SamplePool& pool, Made made) {
  if (file.n.width() != pool.width() || file.n.height() != pool.height()) {
    return fail(ErrorCode::kData,
                "{}: is {} x {}, the recording {} x {}: a selection has the recording's size",
                path.string(), file.n.width(), file.n.height(), pool.width(), pool.height());
  }
  for (int y = 0; y < file.n.height(); ++y) {
    for (int x = 0; x < file.n.width(); ++x) {
      if (file.n(x, y) > pool.capacity(x, y)) {
        return fail(ErrorCode::kData,
                    "{}: asks for {} where the recording has {} (pixel {}, {}): record more or "
                    "ask for fewer",
                    path.string(), counted(file.n(x, y), "sample"), pool.capacity(x, y), x, y);
      }
    }
  }
  Selection selection;
  selection.statistics =
      made == Made::kMeans ? prefix_means(pool, file.n) : prefix_statistics(pool, file.n);
  selection.attenuation = file.attenuation;
  if (made == Made::kAll || (file.signal && made != Made::kMeans)) {
    AnalysisSignal signal;
    GuardCounts guards;
    signal.exposure = exposure_of(selection.statistics, guards);
    if (file.signal) signal = *file.signal;
    set_signal(selection.statistics, pool, signal);
  }
  for (std::size_t h = 0; h < file.halves.size(); ++h) {
    SPOOL_ASSIGN(Selection half,
                 apply_selection(file.halves[h], path, pool.half(static_cast<int>(h))));
    selection.halves.push_back(std::move(half));
  }
  if (file.halves_use == HalvesUse::kApart) return selection;
  Selection joined = join_halves(pool, std::move(selection.halves));
  if (joined.statistics.n == file.n) return joined;
  return fail(ErrorCode::kData,
              "{}: channel n is not the sum of even.n and odd.n: write their sum, or leave even.n "
              "and odd.n out",
              path.string());
}

}  // namespace spool::tools
