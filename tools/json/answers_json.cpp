#include "tools/json/answers_json.h"

#include <cmath>

#include <nlohmann/json.hpp>

#include "formats/dump_check.h"
#include "formats/interchange/dump_import.h"
#include "formats/interchange/export_file.h"
#include "formats/pass_folder.h"
#include "formats/spool_recovery.h"
#include "lib/sampling/sampler.h"
#include "tools/batch/result_changes.h"
#include "tools/json/json_text.h"

namespace spool::tools {
namespace {

using nlohmann::ordered_json;

ordered_json block_json(const format::BlockKey& block) {
  return {{"group", block.group},
          {"tile", block.tile},
          {"sample_begin", block.sample_begin},
          {"sample_count", block.sample_count}};
}

ordered_json record_json(const format::DamagedRecord& record) {
  ordered_json entry = {
      {"type", record.type}, {"offset", record.offset}, {"reason", record.reason}};
  if (record.block) entry["block"] = block_json(*record.block);
  return entry;
}

template <class Items, class AsJson>
ordered_json list_json(const Items& items, const AsJson& as_json) {
  ordered_json list = ordered_json::array();
  for (const auto& item : items)
    list.push_back(as_json(item));
  return list;
}

// Guards that caught something, in the order of lib/core/guards.h.
ordered_json guards_json(const GuardCounts& counts) {
  ordered_json listing = ordered_json::object();
  for (std::size_t g = 0; g < kGuardCount; ++g) {
    const auto guard = static_cast<Guard>(g);
    if (counts[guard] > 0) listing[std::string(guard_name(guard))] = counts[guard];
  }
  return listing;
}

ordered_json metric_number(double value) {
  if (std::isinf(value)) return value > 0 ? "inf" : "-inf";
  return json_number(value);
}

ordered_json change_json(const Change& change) {
  const Interval ratio = change.difference.ratio();
  ordered_json entry = {{"combination", change.key},
                        {"metric", change.metric},
                        {"before", json_number(change.before)},
                        {"after", json_number(change.after)},
                        {"ratio", json_number(ratio.mean)},
                        {"low", json_number(ratio.low)},
                        {"high", json_number(ratio.high)},
                        {"p_holm", json_number(change.p)},
                        {"paired", change.paired},
                        {"biased", change.biased},
                        {"verdict", verdict_name(change.verdict)}};
  if (change.difference.withheld != Withheld::kNo)
    entry["withheld"] = withheld_name(change.difference.withheld);
  return entry;
}

}  // namespace

std::string check_text(const std::string& file, const format::CheckReport& report) {
  return json_text({{"file", file},
                    {"complete", report.complete},
                    {"opens", report.opens},
                    {"records", report.records},
                    {"bytes", report.bytes},
                    {"damaged", list_json(report.damaged, record_json)},
                    {"missing", list_json(report.missing, block_json)}});
}

std::string recovery_text(const std::filesystem::path& input, const std::filesystem::path& output,
                          const format::RecoveryReport& report) {
  return json_text({{"input", input.string()},
                    {"output", output.string()},
                    {"kept_blocks", report.kept_blocks},
                    {"kept_records", report.kept_records},
                    {"lost_records", report.lost_records},
                    {"lost", list_json(report.lost, block_json)},
                    {"absent", list_json(report.absent, block_json)},
                    {"damaged", list_json(report.damaged, record_json)}});
}

std::string import_text(const std::filesystem::path& output,
                        const interchange::ImportReport& report) {
  return json_text({{"file", output.string()},
                    {"width", report.width},
                    {"height", report.height},
                    {"samples_per_pixel", report.spp},
                    {"layers", report.layers},
                    {"notes", report.notes}});
}

std::string export_text(const std::filesystem::path& output, const std::string& format,
                        const interchange::ExportReport& report) {
  return json_text({{"output", output.string()}, {"format", format}, {"notes", report.notes}});
}

std::string pack_text(const std::filesystem::path& output, const format::PackReport& report) {
  return json_text({{"file", output.string()},
                    {"width", report.width},
                    {"height", report.height},
                    {"samples_per_pixel", report.spp},
                    {"reference_samples_per_pixel", report.reference_spp},
                    {"cost_per_sample", report.cost_per_sample},
                    {"layers", report.layers},
                    {"bytes", report.bytes},
                    {"remark", report.remark}});
}

std::string dry_run_text(const DryRun& run) {
  ordered_json layers = ordered_json::array();
  for (const UnusedLayers& one : run.unused)
    layers.push_back({{"recording", one.recording}, {"layers", one.layers}, {"share", one.share}});
  return json_text({{"cells", run.cells},
                    {"done", run.done},
                    {"left", run.left},
                    {"seconds", run.seconds},
                    {"left_of_unknown_time", run.unknown_time},
                    {"unused_layers", layers}});
}

std::string replay_text(const RunFacts& facts, const SamplingLog& log) {
  return json_text({{"sampler", facts.method},
                    {"output", facts.output.string()},
                    {"budget", log.budget},
                    {"initial", log.initial},
                    {"spent", log.spent},
                    {"uniform_remainder", log.uniform_remainder},
                    {"saturated_pieces", log.saturated_pieces},
                    {"samples_of_level", log.samples_of_level},
                    {"guards", guards_json(facts.guards)},
                    {"seconds", facts.seconds}});
}

std::string reconstruction_text(const RunFacts& facts, int width, int height,
                                const std::vector<std::string>& notes) {
  return json_text({{"filter", facts.method},
                    {"output", facts.output.string()},
                    {"width", width},
                    {"height", height},
                    {"notes", notes},
                    {"guards", guards_json(facts.guards)},
                    {"seconds", facts.seconds}});
}

std::string metrics_text(const std::filesystem::path& image, const std::filesystem::path& reference,
                         const std::vector<std::pair<std::string, MetricValue>>& values,
                         const MetricTable& table) {
  ordered_json root = {{"image", image.string()},
                       {"reference", reference.string()},
                       {"metrics", ordered_json::object()}};
  for (const auto& [name, value] : values)
    root["metrics"][name] = {{"value", metric_number(value.value)},
                             {"standard_error", metric_number(value.standard_error)}};
  root["relative_scale"] = table.relative_scale;
  root["pixels_judged"] = table.pixels;
  root["excluded_image"] = table.excluded_estimate;
  root["excluded_reference"] = table.excluded_reference;
  return json_text(root);
}

std::string comparisons_text(const Comparisons& comparisons) {
  ordered_json claims = ordered_json::array(), changes = ordered_json::array();
  for (const ClaimChange& claim : comparisons.claims)
    claims.push_back({{"text", claim.text}, {"before", claim.before}, {"after", claim.after}});
  for (const Change& change : comparisons.changes)
    changes.push_back(change_json(change));
  return json_text({{"claims", claims},
                    {"comparisons", changes},
                    {"newly_failed", comparisons.newly_failed},
                    {"only_before", comparisons.only_before},
                    {"only_after", comparisons.only_after}});
}

}  // namespace spool::tools
