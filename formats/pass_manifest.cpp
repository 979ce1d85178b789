#include "formats/pass_manifest.h"

#include <algorithm>
#include <cmath>
#include <fstream>
#include <limits>
#include <map>
#include <set>

#include "formats/bounded_json.h"

namespace spool::format {

namespace {

using nlohmann::json;
namespace fs = std::filesystem;

constexpr uintmax_t kMaxTextBytes = uintmax_t{256} << 20;  // a line per pass: 65536 need 20 MB

Result<std::string> read_text(const fs::path& path) {
  std::error_code code;
  const uintmax_t size = fs::file_size(path, code);
  if (code) {
    return fail(ErrorCode::kIo, "{}: {}: give a folder of recorded passes", path.string(),
                code.message());
  }
  if (size > kMaxTextBytes) {
    return fail(ErrorCode::kData, "{}: {} bytes are too many for a list of passes", path.string(),
                size);
  }
  std::ifstream stream(path, std::ios::binary);
  std::string text(size, '\0');
  if (!stream.read(text.data(), static_cast<std::streamsize>(size))) {
    return fail(ErrorCode::kIo, "{}: cannot be read", path.string());
  }
  return text;
}

// Numbers of a line; nlohmann would convert -1 and 1.5 silently.
bool take_integer(const json& object, const char* key, uint64_t limit, uint64_t& value) {
  const auto found = object.find(key);
  if (found == object.end() || !found->is_number_unsigned()) return false;
  value = found->get<uint64_t>();
  return value <= limit;
}

bool take_text(const json& object, const char* key, std::string& value) {
  const auto found = object.find(key);
  if (found == object.end() || !found->is_string()) return false;
  value = found->get<std::string>();
  return true;
}

bool is_layer_component(const std::string& name) {
  const size_t dot = name.find('.');
  return name.size() <= 31 && dot != std::string::npos && dot > 0 && dot + 1 < name.size();
}

bool take_channels(const json& recording, std::vector<PassChannel>& channels) {
  const auto list = recording.find("channels");
  if (list == recording.end() || !list->is_array() || list->size() < 3 || list->size() > 64) {
    return false;
  }
  static const std::map<std::string, DataType> types = {{"f16", DataType::kFloat16},
                                                        {"f32", DataType::kFloat32}};
  for (const json& entry : *list) {
    PassChannel channel;
    std::string type;
    if (!entry.is_object() || !take_text(entry, "name", channel.name) ||
        !take_text(entry, "dtype", type) || !types.contains(type) ||
        !is_layer_component(channel.name)) {
      return false;
    }
    channel.type = types.at(type);
    channels.push_back(channel);
  }
  return channels[0].name == "radiance.R" && channels[1].name == "radiance.G" &&
         channels[2].name == "radiance.B";
}

Result<void> read_recording(const fs::path& path, PassManifest& manifest) {
  SPOOL_ASSIGN(const std::string text, read_text(path));
  const json document = parse_json(text);
  uint64_t version = 0;
  std::string format;
  if (!document.is_object() || !take_text(document, "format", format) || format != "spool-passes" ||
      !document.contains("recording") || !document["recording"].is_object()) {
    return fail(ErrorCode::kData, "{}: not a manifest of recorded passes", path.string());
  }
  if (!take_integer(document, "version", 1, version) || version != 1) {
    return fail(ErrorCode::kData, "{}: version is not 1: use a newer spool", path.string());
  }
  const json& recording = document["recording"];
  uint64_t width = 0;
  uint64_t height = 0;
  static const std::set<std::string> modes = {"iid", "shift", "sequence"};
  if (!take_integer(recording, "width", kMaxPassSide, width) || width == 0 ||
      !take_integer(recording, "height", kMaxPassSide, height) || height == 0) {
    return fail(ErrorCode::kData, "{}: width and height must be 1 to {}", path.string(),
                kMaxPassSide);
  }
  if (!take_text(recording, "mode", manifest.mode) || !modes.contains(manifest.mode)) {
    return fail(ErrorCode::kData, "{}: mode must be iid, shift or sequence", path.string());
  }
  if (!take_channels(recording, manifest.channels)) {
    return fail(ErrorCode::kData,
                "{}: channels must be 3 to 64 names with a dtype of f16 or f32, radiance.R, .G, .B "
                "first",
                path.string());
  }
  for (const PassChannel& channel : manifest.channels) {
    if (channel.name.starts_with("reference.") || channel.name.starts_with("reference_variance."))
      return fail(
          ErrorCode::kData,
          "{}: channel {} would be a reference for each sample: packing makes one of batches",
          path.string(), channel.name);
  }
  // Remarks about layers, to which packing adds one about film.
  const auto holds_remarks = [](const json& value) { return value.is_object() || value.is_null(); };
  const json layers = recording.value("layers", json());
  if (!holds_remarks(layers) ||
      (layers.is_object() && !holds_remarks(layers.value("film", json())))) {
    return fail(ErrorCode::kData, "{}: layers must be an object of objects: run the recorder again",
                path.string());
  }
  manifest.width = static_cast<uint32_t>(width);
  manifest.height = static_cast<uint32_t>(height);
  manifest.recording = recording.dump();
  return {};
}

bool take_film(const json& line, PassEntry& entry) {
  const auto film = line.find("film");
  if (film == line.end()) return true;
  if (!film->is_array() || film->size() != 2 || !(*film)[0].is_number() ||
      !(*film)[1].is_number()) {
    return false;
  }
  const double x = (*film)[0].get<double>();
  const double y = (*film)[1].get<double>();
  entry.has_film = true;
  entry.film_x = static_cast<float>(x);
  entry.film_y = static_cast<float>(y);
  return entry.film_x >= 0.0F && entry.film_x < 1.0F && entry.film_y >= 0.0F && entry.film_y < 1.0F;
}

bool take_seconds(const json& line, const char* key, double& value) {
  const auto found = line.find(key);
  if (found == line.end()) return true;
  if (!found->is_number()) return false;
  value = found->get<double>();
  return std::isfinite(value) && value >= 0.0;
}

bool take_folded_seeds(const json& line, PassEntry& entry) {
  const auto seeds = line.find("folded_seeds");
  if (seeds == line.end()) return true;
  if (!seeds->is_array() || seeds->size() < 2 || entry.samples % seeds->size() != 0) return false;
  for (const json& seed : *seeds) {
    if (!seed.is_number_unsigned() || seed.get<uint64_t>() > std::numeric_limits<uint32_t>::max())
      return false;
    entry.folded_seeds.push_back(seed.get<uint32_t>());
  }
  return true;
}

bool take_entry(const json& line, const fs::path& folder, std::string& kind, PassEntry& entry) {
  std::string file;
  uint64_t crc = 0;
  uint64_t seed = 0;
  constexpr uint64_t u32 = std::numeric_limits<uint32_t>::max();
  if (!line.is_object() || !take_text(line, "kind", kind) || !take_text(line, "file", file) ||
      !take_integer(line, "index", u32, entry.index) || !take_integer(line, "crc32", u32, crc) ||
      !take_integer(line, "seed", u32, seed) ||
      !take_integer(line, "sample_index", u32, entry.sample_index) ||
      !take_integer(line, "samples", u32, entry.samples) || entry.samples == 0 ||
      !take_film(line, entry) || !take_folded_seeds(line, entry)) {
    return false;
  }
  if (line.contains("codec") && line["codec"] != "zstd-shuffle") return false;
  entry.packed = line.contains("codec");
  if (!take_seconds(line, "seconds", entry.seconds) ||
      !take_seconds(line, "cpu_seconds", entry.cpu_seconds)) {
    return false;
  }
  // a name of this folder, never a way out of it
  if (file.empty() || fs::path(file).filename().string() != file || file == "." || file == "..") {
    return false;
  }
  entry.file = folder / file;
  entry.crc32 = static_cast<uint32_t>(crc);
  entry.seed = static_cast<uint32_t>(seed);
  return kind == "pass" ? entry.samples == 1 && entry.folded_seeds.empty() : kind == "reference";
}

Result<void> read_entries(const fs::path& path, PassManifest& manifest) {
  SPOOL_ASSIGN(const std::string text, read_text(path));
  std::map<uint64_t, PassEntry> passes;
  std::map<uint64_t, PassEntry> batches;
  size_t begin = 0;
  size_t number = 0;
  for (size_t end = 0; (end = text.find('\n', begin)) != std::string::npos; begin = end + 1) {
    ++number;
    PassEntry entry;
    std::string kind;
    const json line = parse_json(std::string_view(text).substr(begin, end - begin));
    if (!take_entry(line, manifest.folder, kind, entry)) {
      return fail(ErrorCode::kData,
                  "{}: line {} is no entry of a pass: remove it and run the recorder again",
                  path.string(), number);
    }
    // a pass that was rendered again has two lines; the later one is its file's
    (kind == "pass" ? passes : batches)[entry.index] = entry;
  }
  for (auto& [index, entry] : passes)
    manifest.passes.push_back(std::move(entry));
  for (auto& [index, entry] : batches)
    manifest.batches.push_back(std::move(entry));
  return {};
}

std::string difference(const json& there, const json& here, const std::string& path) {
  if (there.is_object() && here.is_object()) {
    std::set<std::string> keys;
    for (const auto& item : there.items())
      keys.insert(item.key());
    for (const auto& item : here.items())
      keys.insert(item.key());
    for (const std::string& key : keys) {
      if (path.empty() && key == "seed") continue;
      const std::string inner = path.empty() ? key : fmt::format("{}.{}", path, key);
      const std::string found =
          difference(there.value(key, json()), here.value(key, json()), inner);
      if (!found.empty()) return found;
    }
    return {};
  }
  if (there == here) return {};
  return fmt::format("{}: {} there, {} here", path, there.dump().substr(0, 60),
                     here.dump().substr(0, 60));
}

}  // namespace

Result<PassManifest> read_pass_manifest(const std::filesystem::path& folder) {
  PassManifest manifest;
  manifest.folder = folder;
  SPOOL_TRY(read_recording(folder / "manifest.json", manifest));
  SPOOL_TRY(read_entries(folder / "passes.jsonl", manifest));
  if (manifest.passes.empty()) {
    return fail(ErrorCode::kData, "{}: no finished pass: run the recorder again", folder.string());
  }
  return manifest;
}

std::vector<uint32_t> PassManifest::batch_seeds() const {
  if (is_folded()) return batches[0].folded_seeds;
  std::vector<uint32_t> seeds;
  for (const PassEntry& batch : batches)
    seeds.push_back(batch.seed);
  return seeds;
}

uint64_t PassManifest::batch_samples() const {
  if (batches.empty()) return 0;
  return is_folded() ? batches[0].samples / batches[0].folded_seeds.size() : batches[0].samples;
}

std::string recording_difference(const std::string& there, const std::string& here) {
  return difference(parse_json(there), parse_json(here), "");
}

}  // namespace spool::format
