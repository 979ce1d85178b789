#include "formats/pass_recording.h"

#include <algorithm>
#include <map>
#include <utility>

#include "formats/bounded_json.h"
#include "formats/pass_file.h"

namespace spool::format {

namespace {

using nlohmann::json;

constexpr size_t kMaxSeedsInMeta =
    4096;  // meta is at most 1 MiB; the recording holds all as `seed.S`

Result<void> append_folder(const std::filesystem::path& folder, PassRecording& recording) {
  SPOOL_ASSIGN(PassManifest next, read_pass_manifest(folder));
  PassManifest& first = recording.manifest;
  const std::string difference = recording_difference(first.recording, next.recording);
  if (!difference.empty()) {
    return fail(ErrorCode::kData, "{}: another recording than {} ({}): pack them apart",
                folder.string(), first.folder.string(), difference);
  }
  if (first.mode == "sequence") {
    return fail(ErrorCode::kData,
                "{}: samples of a sequence belong together in one folder: pack it alone",
                folder.string());
  }
  std::move(next.passes.begin(), next.passes.end(), std::back_inserter(first.passes));
  std::move(next.batches.begin(), next.batches.end(), std::back_inserter(first.batches));
  recording.others.push_back(std::move(next.recording));
  return {};
}

// A seed stands for its samples: pool and reference, folder and folder must not share one. Index 0
// and 1 of one seed are not independent either.
Result<void> check_seeds(const PassManifest& manifest) {
  std::map<uint32_t, const PassEntry*> seen;
  const bool sequence = manifest.mode == "sequence";
  for (const auto* list : {&manifest.passes, &manifest.batches}) {
    for (const PassEntry& entry : *list) {
      const bool folded = !entry.folded_seeds.empty();
      for (const uint32_t seed : folded ? entry.folded_seeds : std::vector{entry.seed}) {
        const auto [place, fresh] = seen.emplace(seed, &entry);
        if (fresh || (sequence && list == &manifest.passes)) continue;
        return fail(ErrorCode::kData,
                    "{}: has the seed {} of {}: the samples are not independent, "
                    "record one of them with another --seed or --first",
                    entry.file.string(), seed, place->second->file.string());
      }
    }
  }
  return {};
}

Result<void> check_sequence(const PassManifest& manifest) {
  if (manifest.mode != "sequence") return {};
  const PassEntry& first = manifest.passes.front();
  for (size_t i = 0; i < manifest.passes.size(); ++i) {
    const PassEntry& entry = manifest.passes[i];
    if (entry.seed == first.seed && entry.index == i &&
        entry.sample_index == first.sample_index + i) {
      continue;
    }
    return fail(ErrorCode::kData,
                "{}: sample {} of the sequence is missing before it: run the recorder again",
                entry.file.string(), i);
  }
  return {};
}

Result<void> check_film(const PassManifest& manifest) {
  const bool wanted = manifest.passes.front().has_film;
  for (const PassEntry& entry : manifest.passes) {
    if (entry.has_film != wanted) {
      return fail(ErrorCode::kData, "{}: its film position is {}: record it again",
                  entry.file.string(), wanted ? "not known" : "known, of the first pass it is not");
    }
  }
  return {};
}

Result<void> check_batches(const PassManifest& manifest) {
  if (manifest.is_folded()) return {};
  for (const PassEntry& batch : manifest.batches) {
    if (batch.folded_seeds.empty()) continue;
    return fail(ErrorCode::kData,
                "{}: its batches are folded to one file and cannot be joined with others: pack the "
                "folders apart",
                batch.file.string());
  }
  for (const PassEntry& batch : manifest.batches) {
    if (batch.samples != manifest.batches.front().samples) {
      return fail(ErrorCode::kData,
                  "{}: a batch of {} samples among batches of {}: record the reference in one way",
                  batch.file.string(), batch.samples, manifest.batches.front().samples);
    }
  }
  return {};
}

// Per sample of every pixel: CPU time, or wall time where that is all there is. CPU time stands
// still while other programs have the machine.
double median_seconds(const std::vector<PassEntry>& entries, bool cpu) {
  std::vector<double> seconds;
  for (const PassEntry& entry : entries) {
    const double spent = cpu ? entry.cpu_seconds : entry.seconds;
    if (spent > 0.0) seconds.push_back(spent / static_cast<double>(entry.samples));
  }
  if (seconds.empty()) return 0.0;
  const auto middle = seconds.begin() + static_cast<std::ptrdiff_t>(seconds.size() / 2);
  std::nth_element(seconds.begin(), middle, seconds.end());
  return *middle;
}

bool has_cpu_seconds(const PassManifest& manifest) {
  return std::all_of(manifest.passes.begin(), manifest.passes.end(),
                     [](const PassEntry& entry) { return entry.cpu_seconds > 0.0; });
}

json first_of(std::vector<uint32_t> seeds) {
  seeds.resize(std::min(seeds.size(), kMaxSeedsInMeta));
  return seeds;
}

double pixels(const PassManifest& manifest) {
  return static_cast<double>(manifest.width) * manifest.height;
}

}  // namespace

Result<PassRecording> read_pass_recording(const std::vector<std::filesystem::path>& folders) {
  if (folders.empty()) return fail(ErrorCode::kUsage, "no folder of passes: name at least one");
  PassRecording recording;
  SPOOL_ASSIGN(recording.manifest, read_pass_manifest(folders.front()));
  for (size_t i = 1; i < folders.size(); ++i)
    SPOOL_TRY(append_folder(folders[i], recording));
  const PassManifest& manifest = recording.manifest;
  SPOOL_TRY(check_seeds(manifest));
  SPOOL_TRY(check_sequence(manifest));
  SPOOL_TRY(check_film(manifest));
  SPOOL_TRY(check_batches(manifest));
  for (const PassEntry& entry : manifest.passes) {
    SPOOL_TRY(verify_pass_file(manifest, entry, static_cast<uint32_t>(manifest.channels.size())));
  }
  for (const PassEntry& entry : manifest.batches)
    SPOOL_TRY(verify_pass_file(manifest, entry, manifest.batch_channels()));
  return recording;
}

double cost_per_sample(const PassRecording& recording) {
  const PassManifest& manifest = recording.manifest;
  return median_seconds(manifest.passes, has_cpu_seconds(manifest)) / pixels(manifest);
}

std::string recording_meta(const PassRecording& recording) {
  const PassManifest& manifest = recording.manifest;
  const json source = parse_json(manifest.recording);
  json meta;
  for (const char* key : {"renderer", "scene", "camera", "frame", "view_layer", "needs", "mode",
                          "settings", "mist_depth", "group"}) {
    if (source.contains(key)) meta[key] = source[key];
  }
  meta["version"] = source.value("renderer_version", json());
  meta["channels"] = source.value("layers", json::object());
  meta["recording_seeds"] = json::array({source.value("seed", json())});
  for (const std::string& other : recording.others) {
    meta["recording_seeds"].push_back(parse_json(other).value("seed", json()));
  }
  std::vector<uint32_t> seeds;
  for (const PassEntry& pass : manifest.passes)
    seeds.push_back(pass.seed);
  meta["seeds"] = first_of(std::move(seeds));
  meta["sample_index"] = manifest.passes.front().sample_index;
  meta["cost_per_sample"] = cost_per_sample(recording);
  const bool cpu = has_cpu_seconds(manifest);
  meta["cost_note"] = std::string(cpu ? "CPU" : "wall") +
                      " seconds of a sample: median over passes of one sample per pixel";
  double wall = 0.0;
  for (const auto* list : {&manifest.passes, &manifest.batches}) {
    for (const PassEntry& entry : *list)
      wall += entry.seconds;
  }
  meta["wall_seconds"] = wall;
  if (manifest.passes.front().has_film) {
    meta["channels"]["film"]["note"] = "y down; the same for all pixels of a pass";
  }
  if (!manifest.batches.empty()) {
    const uint64_t each = manifest.batch_samples();
    const std::vector<uint32_t> batch_seeds = manifest.batch_seeds();
    meta["reference"] = {
        {"samples", each * batch_seeds.size()},
        {"batches", batch_seeds.size()},
        {"samples_per_batch", each},
        {"independent", true},
        {"stratified", each > 1},
        {"seeds", first_of(batch_seeds)},
        {"cost_per_sample", median_seconds(manifest.batches, cpu) / pixels(manifest)},
        {"note",
         "mean of independent batches from other seeds than the samples; reference_variance is the "
         "variance of that mean from the batch means (Welford, double)"}};
  }
  return meta.dump(-1, ' ', false, json::error_handler_t::replace);
}

}  // namespace spool::format
