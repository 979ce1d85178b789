#include "tools/batch/unused_layers.h"

#include <algorithm>
#include <filesystem>

#include <fmt/ranges.h>

#include "formats/spool_reader.h"
#include "lib/core/visible_text.h"
#include "tools/methods/method_memory.h"

namespace spool::tools {
namespace {

// What the methods read beside radiance.
Needs needs_of(const Plan& plan) {
  Needs all{.film_positions = plan.experiment.pieces_per_side > 1 ? Use::kRequired : Use::kNone};
  const auto methods = demands_of(plan.samplers, plan.filters);
  if (!methods) return all;  // the run says what is wrong with one of them
  for (const auto* kind : {&methods->samplers, &methods->filters}) {
    for (const Demands& method : *kind) {
      all.features = std::max(all.features, method.needs.features);
      all.film_positions = std::max(all.film_positions, method.needs.film_positions);
    }
  }
  return all;
}

bool is_read(const std::string& layer, const Needs& needs) {
  if (layer == "radiance") return true;
  if (layer == "film") return needs.film_positions != Use::kNone;
  const bool is_feature = layer == "albedo" || layer == "normal" || layer == "depth";
  return is_feature && needs.features != Use::kNone;
}

}  // namespace

std::vector<UnusedLayers> unused_layers(const Plan& plan) {
  const Needs needs = needs_of(plan);
  std::vector<UnusedLayers> found;
  for (const std::string& path : plan.recordings) {
    const auto reader = format::SpoolReader::open(path);
    if (!reader) continue;
    UnusedLayers unused;
    unused.recording = std::filesystem::path(path).filename().string();
    double all = 0.0, not_read = 0.0;
    for (const format::LayerInfo& layer : reader->layers()) {
      if (layer.scope != format::Scope::kSample) continue;
      const double bytes = layer.channel_count * format::bytes_per_value(layer.type);
      all += bytes;
      if (is_read(layer.name, needs)) continue;
      not_read += bytes;
      unused.layers.push_back(layer.name);
    }
    unused.share = not_read / all;
    if (!unused.layers.empty()) found.push_back(std::move(unused));
  }
  return found;
}

std::string unused_layers_text(const std::vector<UnusedLayers>& unused) {
  std::string text;
  for (const UnusedLayers& one : unused) {
    text +=
        visible_text(fmt::format("{}: no method of the plan reads {} ({:.0f} % of the bytes of "
                                 "a sample)",
                                 one.recording, fmt::join(one.layers, ", "), 100.0 * one.share)) +
        "\n";
  }
  return text;
}

}  // namespace spool::tools
