#include "tools/batch/run_manifest.h"

#include <fstream>
#include <iterator>
#include <thread>

#include <fmt/chrono.h>
#include <sys/utsname.h>
#include <unistd.h>

#include "formats/bounded_json.h"
#include "lib/core/visible_text.h"
#include "lib/experiment/experiment.h"
#include "lib/image_io/atomic_file.h"
#include "tools/methods/external_methods.h"

namespace spool::tools {
namespace {

using nlohmann::ordered_json;

// The words of this process's command line, as the system keeps them; empty where it does not.
std::string command_line() {
  std::ifstream file("/proc/self/cmdline", std::ios::binary);
  std::string bytes;  // words that end in 0; a read that fails ends it
  for (std::string word; std::getline(file, word, '\0');)
    bytes += word + '\0';
  std::string text;
  for (std::size_t at = 0; at < bytes.size();) {
    const std::size_t end = std::min(bytes.find('\0', at), bytes.size());
    text += (text.empty() ? "" : " ") + shell_word(bytes.substr(at, end - at));
    at = end + 1;
  }
  return text;
}

std::string processor() {
  std::ifstream file("/proc/cpuinfo");
  for (std::string line; std::getline(file, line);) {
    const std::size_t colon = line.find(": ");
    if (line.starts_with("model name") && colon != std::string::npos) return line.substr(colon + 2);
  }
  return "unknown processor";
}

ordered_json machine() {
  utsname system{};
  uname(&system);
  const double bytes =
      static_cast<double>(sysconf(_SC_PHYS_PAGES)) * static_cast<double>(sysconf(_SC_PAGESIZE));
  return {{"processor", processor()},
          {"threads", std::thread::hardware_concurrency()},
          {"memory", fmt::format("{:.1f} GB", bytes / 1e9)},
          {"system", fmt::format("{} {} {}", system.sysname, system.release, system.machine)},
          {"compiler", __VERSION__}};
}

// Every option as it was, the defaults too.
template <class Function>
ordered_json methods_json(const std::vector<MethodChoice>& methods,
                          const MethodList<Function>& known) {
  ordered_json list = ordered_json::array();
  for (const MethodChoice& method : methods) {
    ordered_json json = {{"name", method.name}, {"label", method.label()}};
    ordered_json options = ordered_json::object();
    if (const Method<Function>* entry = find_method(known, method.name)) {
      json["by_description"] = entry->source == Source::kDescriptions;
      const std::string first = entry->presets.empty() ? "" : entry->presets.front();
      const std::string preset = method.preset.empty() ? first : method.preset;
      if (!preset.empty()) json["preset"] = preset;
      for (const OptionDescription& option : entry->describe(preset))
        options[option.name] = option.value;
    }
    for (const auto& [name, value] : method.set)
      options[name] = value;
    json["options"] = std::move(options);
    list.push_back(json);
  }
  return list;
}

template <class Options>
ordered_json options_json(const OptionTable<Options>& table, const Options& options) {
  ordered_json json = ordered_json::object();
  for (const auto& [name, value] : option_values(table, options))
    json[name] = value;
  return json;
}

ordered_json plan_json(const Plan& plan) {
  const ExperimentOptions& e = plan.experiment;
  return {{"title", plan.title},
          {"samplers", methods_json(plan.samplers, known_samplers())},
          {"filters", methods_json(plan.filters, known_filters())},
          {"spp", plan.spp},
          {"replicates", plan.replicates},
          {"threads", plan.threads},
          {"repeats", e.repeats},
          {"seed", e.seed},
          {"order", std::string(order_name(e.order))},
          {"reference", e.reference ? std::string(reference_name(*e.reference)) : "best available"},
          {"pieces_per_side", e.pieces_per_side},
          {"decision_split", e.decision_split},
          {"fresh", e.fresh},
          {"pool", options_json(sanitise_option_table(), plan.rules)},
          {"metrics", options_json(metric_option_table(), e.metrics)}};
}

ordered_json read_shards(const std::filesystem::path& folder) {
  ordered_json shards = ordered_json::array();
  for (const std::filesystem::path& path : shard_manifests(folder)) {
    auto shard = format::parse_json_file<ordered_json>(path);
    if (!shard.is_object()) continue;
    shard.erase("plan");
    shard.erase("dumps");
    shards.push_back(shard);
  }
  return shards;
}

// Of a folder that was filled by several runs, one after the other.
ordered_json earlier_runs(const std::filesystem::path& folder) {
  const auto manifest = format::parse_json_file<ordered_json>(folder / "manifest.json");
  const bool known = manifest.is_object() && manifest.contains("runs");
  return known && manifest["runs"].is_array() ? manifest["runs"] : ordered_json::array();
}

}  // namespace

std::set<std::filesystem::path> shard_manifests(const std::filesystem::path& folder) {
  std::set<std::filesystem::path> paths;
  std::error_code status;
  for (const auto& entry : std::filesystem::directory_iterator(folder, status)) {
    const std::string name = entry.path().filename().string();
    if (name.starts_with("manifest-shard-") && name.ends_with(".json")) paths.insert(entry.path());
  }
  return paths;
}

Result<void> write_manifest(const RunRequest& request, const std::vector<DumpIdentity>& dumps,
                            std::chrono::system_clock::time_point started) {
  using std::chrono::system_clock;
  const std::chrono::duration<double> taken = system_clock::now() - started;
  ordered_json manifest = {{"command", command_line()},
                           {"version", "spool " SPOOL_VERSION},
                           {"machine", machine()},
                           {"started", fmt::format("{:%Y-%m-%dT%H:%M:%SZ}",
                                                   fmt::gmtime(system_clock::to_time_t(started)))},
                           {"seconds", taken.count()},
                           {"dumps", ordered_json::array()}};
  for (const DumpIdentity& dump : dumps) {
    manifest["dumps"].push_back({{"path", dump.name},
                                 {"file", dump.path.string()},  // from wherever it is looked for
                                 {"bytes", dump.bytes},
                                 {"index_sha256", dump.index_sha256}});
  }
  manifest["runs"] = earlier_runs(request.folder);
  manifest["runs"].push_back({{"started", manifest["started"]},
                              {"seconds", manifest["seconds"]},
                              {"command", manifest["command"]}});
  manifest["plan"] = plan_json(request.plan);
  std::string name = "manifest.json";
  if (const std::optional<Shard>& shard = request.shard) {
    manifest["shard"] = fmt::format("{}/{}", shard->index, shard->count);
    name = fmt::format("manifest-shard-{}-of-{}.json", shard->index, shard->count);
  } else if (ordered_json shards = read_shards(request.folder); !shards.empty()) {
    manifest["shards"] = shards;
  }
  return write_text_file(
      request.folder / name,
      manifest.dump(2, ' ', false, ordered_json::error_handler_t::replace) + "\n", true, true);
}

}  // namespace spool::tools
