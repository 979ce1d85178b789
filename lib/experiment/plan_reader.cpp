#include "lib/experiment/plan_reader.h"

#include <algorithm>
#include <charconv>
#include <cstdint>
#include <fstream>
#include <functional>
#include <iterator>
#include <limits>
#include <map>

#include <toml++/toml.h>

#include "lib/core/nearest_name.h"
#include "lib/experiment/plan_claims.h"
#include "lib/experiment/toml_nesting.h"
#include "lib/experiment/toml_reader.h"

namespace spool {
namespace {

constexpr std::uintmax_t kLargestPlan = std::uintmax_t{16} << 20;  // bytes of a file

// As large as TOML has numbers.
Result<std::uint64_t> parse_seed(const std::string& text) {
  std::int64_t seed = -1;
  const char* end = text.data() + text.size();
  const auto parsed = std::from_chars(text.data(), end, seed);
  if (parsed.ec == std::errc() && parsed.ptr == end && seed >= 0) {
    return static_cast<std::uint64_t>(seed);
  }
  return fail(ErrorCode::kUsage, "seed: write a whole number from 0 to {}, not '{}'",
              std::numeric_limits<std::int64_t>::max(), text);
}

Result<bool> parse_flag(std::string_view name, std::string_view text) {
  if (text == "on" || text == "off") return text == "on";
  return fail(ErrorCode::kUsage, "{} is true or false, not '{}'", name, text);
}

class PlanReader : private TomlReader {
 public:
  PlanReader(const toml::table& root, std::string name, std::filesystem::path folder)
      : TomlReader(std::move(name)), root_(root), folder_(std::move(folder)) {}

  Result<Plan> read(const PlanVocabulary& vocabulary) {
    Plan plan;
    SPOOL_TRY(check_keys());
    SPOOL_TRY(read_value("title", plan.title,
                         [](const std::string& text) -> Result<std::string> { return text; }));
    SPOOL_TRY(read_recordings(plan));
    SPOOL_TRY(read_energy_band(plan));
    SPOOL_TRY(read_budgets(plan));
    SPOOL_TRY(read_experiment(plan));
    bool halves = true;
    SPOOL_TRY(read_flag("halves", halves));
    plan.experiment.halves = halves ? plan.measured_halves() : 0;
    SPOOL_TRY(read_options("pool", sanitise_option_table(), plan.rules));
    SPOOL_TRY(read_metrics(plan.experiment.metrics));
    SPOOL_TRY(read_methods(*this, root_, vocabulary, plan));
    SPOOL_TRY(read_masks(plan));
    SPOOL_TRY(read_baseline(plan));
    SPOOL_TRY(read_claims(*this, root_, plan));
    add_needed_metrics(plan);
    SPOOL_TRY(check_recording_names(plan));
    return plan;
  }

 private:
  Result<void> check_keys() const {
    const std::vector<std::string> known = {"title",       "recordings",     "spp",
                                            "replicates",  "seed",           "order",
                                            "reference",   "holdout",        "pieces_per_side",
                                            "samplers",    "filters",        "sampler",
                                            "filter",      "pool",           "metrics",
                                            "threads",     "repeats",        "pictures",
                                            "mask",        "decision_split", "dump",
                                            "energy_band", "fresh",          "claim",
                                            "halves",      "baseline"};
    for (const auto& [key, node] : root_) {
      if (std::ranges::find(known, key.str()) != known.end()) continue;
      return refuse(node, "{}", unknown_name("key", key.str(), known));
    }
    return {};
  }

  template <class Value, class Parse>
  Result<void> read_value(const char* key, Value& value, Parse&& parse) const {
    const toml::node* node = root_.get(key);
    if (!node) return {};
    SPOOL_ASSIGN(const std::string text, text_of(*node));
    auto parsed = parse(text);
    if (!parsed) return refuse(*node, "{}", parsed.error().message);
    value = *parsed;
    return {};
  }

  Result<void> read_flag(const char* key, bool& value) const {
    return read_value(key, value, [key](const std::string& text) { return parse_flag(key, text); });
  }

  // The values of a list; no two are alike.
  template <class Value, class Parse>
  Result<void> read_list(const char* key, const toml::node& node, std::vector<Value>& values,
                         Parse&& parse) const {
    for (const toml::node* item : values_of(node)) {
      SPOOL_ASSIGN(const std::string text, text_of(*item));
      SPOOL_ASSIGN(const Value value, at(*item, parse(text)));
      if (std::ranges::find(values, value) != values.end())
        return refuse(*item, "{} {} is there twice", key, value);
      values.push_back(value);
    }
    return {};
  }

  // The texts of every table of a list, by their keys; `keys` are all that it may have, `all` says
  // so in an error.
  template <class Take>
  Result<void> read_tables(const toml::node& tables, const std::string& what,
                           const std::vector<std::string>& keys, const std::string& all,
                           const char* write, Take&& take) const {
    for (const toml::node* node : values_of(tables)) {
      const toml::table* table = node->as_table();
      if (!table) return refuse(*node, "{}", write);
      std::map<std::string, std::string> texts;
      for (const auto& [key, value] : *table) {
        SPOOL_ASSIGN(texts[std::string(key.str())], text_of(value));
        if (std::ranges::find(keys, key.str()) == keys.end())
          return refuse(value, "{}", unknown_name("key of " + what, key.str(), keys, all));
      }
      SPOOL_TRY(take(*table, texts));
    }
    return {};
  }

  std::string path_of(const std::string& text) const {
    return (folder_ / file_of_text(text)).lexically_normal().string();
  }

  Result<void> read_recordings(Plan& plan) const {
    const toml::node* node = root_.get("recordings");
    if (node) {
      for (const toml::node* value : values_of(*node)) {
        SPOOL_ASSIGN(const std::string text, text_of(*value));
        plan.recordings.push_back(path_of(text));
      }
    }
    SPOOL_TRY(read_dumps(plan));
    if (plan.recordings.empty()) {
      return fail(ErrorCode::kUsage, "{}: no recordings: write recordings = [\"FILE.spool\"]",
                  name());
    }
    return {};
  }

  Result<void> read_dumps(Plan& plan) const {
    const toml::node* tables = root_.get("dump");
    if (!tables) return {};
    return read_tables(*tables, "a recording", {"file", "group"}, ": it has file and group",
                       "write [[dump]] and below it file = ... and group = ...",
                       [&](const toml::table& table, auto& texts) -> Result<void> {
                         if (texts["file"].empty())
                           return refuse(table, "this recording has no file");
                         plan.groups.resize(plan.recordings.size());
                         plan.recordings.push_back(path_of(texts["file"]));
                         plan.groups.push_back(texts["group"]);
                         return {};
                       });
  }

  Result<void> read_energy_band(Plan& plan) const {
    const toml::node* node = root_.get("energy_band");
    if (!node) return {};
    const std::vector<const toml::node*> values = values_of(*node);
    if (values.size() != 2) return refuse(*node, "energy_band is two ratios: [0.98, 1.02]");
    std::vector<double> ends;
    for (const toml::node* value : values) {
      SPOOL_ASSIGN(const std::string text, text_of(*value));
      SPOOL_ASSIGN(ends.emplace_back(), at(*value, parse_number("energy_band", text, 0.0, 1e6)));
    }
    if (!(ends[0] < ends[1])) return refuse(*node, "energy_band: the lower ratio comes first");
    plan.energy_band = {ends[0], ends[1]};
    return {};
  }

  Result<void> read_budgets(Plan& plan) const {
    const toml::node* node = root_.get("spp");
    if (!node || values_of(*node).empty()) {
      return fail(ErrorCode::kUsage, "{}: no budgets: write spp = [4, 8, 16]", name());
    }
    if (values_of(*node).size() > kMostValues) {
      return refuse(*node, "{} budgets: give at most {}", values_of(*node).size(), kMostValues);
    }
    return read_list("spp", *node, plan.spp, [](const std::string& text) {
      return parse_number("spp", text, 1e-3, 65536.0);
    });
  }

  Result<void> read_experiment(Plan& plan) const {
    const auto integer = [](const char* key, int lowest, int highest) {
      return [=](const std::string& text) { return parse_integer(key, text, lowest, highest); };
    };
    SPOOL_TRY(read_value("replicates", plan.replicates, integer("replicates", 1, 10000)));
    SPOOL_TRY(read_value("seed", plan.experiment.seed, parse_seed));
    SPOOL_TRY(read_value("holdout", plan.experiment.holdout, integer("holdout", 0, 65536)));
    SPOOL_TRY(read_value("pieces_per_side", plan.experiment.pieces_per_side,
                         integer("pieces_per_side", 1, 2)));
    SPOOL_TRY(read_value("repeats", plan.experiment.repeats, integer("repeats", 1, 1000)));
    SPOOL_TRY(read_threads(plan));
    SPOOL_TRY(read_flag("pictures", plan.pictures));
    SPOOL_TRY(read_flag("decision_split", plan.experiment.decision_split));
    SPOOL_TRY(read_flag("fresh", plan.experiment.fresh));
    SPOOL_TRY(read_value("reference", plan.experiment.reference, parse_reference_kind));
    SPOOL_TRY(read_order(plan));
    // There is one recorded order.
    if (plan.experiment.order == ReplicateOrder::kRecorded && !root_.get("replicates"))
      plan.replicates = 1;
    return {};
  }

  Result<void> read_order(Plan& plan) const {
    return read_value(
        "order", plan.experiment.order, [](const std::string& text) -> Result<ReplicateOrder> {
          for (const ReplicateOrder order :
               {ReplicateOrder::kDisjoint, ReplicateOrder::kShuffled, ReplicateOrder::kRecorded}) {
            if (text == order_name(order)) return order;
          }
          return fail(ErrorCode::kUsage, "order is disjoint, shuffled or recorded, not '{}'", text);
        });
  }

  Result<void> read_threads(Plan& plan) const {
    const toml::node* node = root_.get("threads");
    if (!node) return {};
    plan.threads.clear();
    SPOOL_TRY(read_list("threads", *node, plan.threads, [](const std::string& text) {
      return parse_integer("threads", text, 0, 1024);
    }));
    if (plan.threads.empty()) return refuse(*node, "'threads' has no value to sweep over");
    return {};
  }

  static Result<void> check_mask(const Plan& plan, const EnergyMask& mask) {
    std::vector<std::string> files;
    for (const std::string& recording : plan.recordings)
      files.push_back(std::filesystem::path(recording).filename().string());
    if (!mask.recording.empty() && std::ranges::find(files, mask.recording) == files.end())
      return fail(ErrorCode::kUsage, "{}",
                  unknown_name("recording of the plan", mask.recording, files));
    for (const EnergyMask& other : plan.experiment.masks)
      if (other.name == mask.name &&
          (other.recording == mask.recording || other.recording.empty() || mask.recording.empty()))
        return fail(ErrorCode::kUsage, "mask {} is there twice: name one otherwise", mask.name);
    return {};
  }

  Result<void> read_masks(Plan& plan) const {
    const toml::node* tables = root_.get("mask");
    if (!tables) return {};
    const auto take = [&](const toml::table& table, auto& texts) -> Result<void> {
      EnergyMask mask{texts["name"], "", texts["file"], {}};
      if (mask.name.find_first_of(" =") != std::string::npos || mask.name.empty() ||
          mask.path.empty()) {
        return refuse(table, "a mask requires a name without spaces and a file");
      }
      mask.path = path_of(mask.path);
      mask.recording = std::filesystem::path(file_of_text(texts["recording"])).filename().string();
      SPOOL_TRY(at(table, check_mask(plan, mask)));
      plan.experiment.masks.push_back(std::move(mask));
      return {};
    };
    return read_tables(*tables, "a mask", {"name", "file", "recording"},
                       ": it has name, file and recording",
                       "write [[mask]] and below it name = ... and file = ...", take);
  }

  Result<void> read_baseline(Plan& plan) const {
    const toml::node* node = root_.get("baseline");
    if (!node) return {};
    SPOOL_ASSIGN(plan.baseline, text_of(*node));
    return at(*node, check_method_name(plan, plan.baseline));
  }

  // metrics = ["relmse", ...], or the table of options with `only` in it.
  Result<void> read_metrics(MetricOptions& options) const {
    const toml::node* node = root_.get("metrics");
    if (!node) return {};
    const toml::table* table = node->as_table();
    const toml::node* only = table ? table->get("only") : node;
    if (table) SPOOL_TRY(read_options("metrics", metric_option_table(), options, "only"));
    if (!only) return {};
    std::vector<std::string> names;
    for (const toml::node* value : values_of(*only)) {
      SPOOL_ASSIGN(names.emplace_back(), text_of(*value));
      SPOOL_TRY(at(*value, metrics_named(names)));
    }
    if (names.empty()) return refuse(*only, "no metric: leave it out for all of them");
    SPOOL_ASSIGN(options.wanted, metrics_named(names));
    return {};
  }

  // What tables and claims are made of.
  static void add_needed_metrics(Plan& plan) {
    std::vector<bool>& wanted = plan.experiment.metrics.wanted;
    if (wanted.empty()) return;
    std::vector<std::string> needed = {"relmse", "mse", "energy_ratio"};
    for (const Claim& claim : plan.claims)
      needed.push_back(claim.metric);
    for (const std::string& name : needed) {
      if (const int metric = metric_index(name); metric >= 0)
        wanted[static_cast<std::size_t>(metric)] = true;
    }
    if (std::ranges::all_of(wanted, std::identity())) wanted.clear();
  }

  // `apart`: a key of the table that is none of the options.
  template <class Options>
  Result<void> read_options(const char* key, const OptionTable<Options>& table, Options& options,
                            std::string_view apart = {}) const {
    const toml::node* node = root_.get(key);
    if (!node) return {};
    const toml::table* values = node->as_table();
    if (!values) return refuse(*node, "[{}] is a table of options", key);
    for (const auto& [name, value] : *values) {
      if (name.str() == apart) continue;
      SPOOL_ASSIGN(const std::string text, text_of(value));
      const auto set = set_option(table, options, name.str(), text);
      if (!set) return refuse(value, "{}", set.error().message);
    }
    return {};
  }

  const toml::table& root_;
  std::filesystem::path folder_;
};

}  // namespace

Result<Plan> parse_plan(std::string_view text, const std::string& name,
                        const std::filesystem::path& folder, const PlanVocabulary& vocabulary) {
  if (text.size() > kMaxTomlBytes) {
    return fail(ErrorCode::kUsage, "{}: {} bytes are more than the {} of a plan: split it", name,
                text.size(), kMaxTomlBytes);
  }
  if (const std::size_t line = line_nested_too_deeply(text); line != 0) {
    return fail(ErrorCode::kUsage, "{}:{}: keys or brackets nest deeper than {}: correct the TOML",
                name, line, kMaxTomlDepth);
  }
  toml::table root;
  try {
    root = toml::parse(text, name);
  } catch (const toml::parse_error& error) {
    return fail(ErrorCode::kUsage, "{}:{}: {}: correct the TOML", name, error.source().begin.line,
                error.description());
  }
  return PlanReader(root, name, folder).read(vocabulary);
}

Result<Plan> read_plan(const std::filesystem::path& path, const PlanVocabulary& vocabulary) {
  std::error_code status;
  if (std::filesystem::exists(path, status) && !std::filesystem::is_regular_file(path, status)) {
    return fail(ErrorCode::kUsage, "{}: is no regular file: give a plan on disk", path.string());
  }
  const std::uintmax_t bytes = std::filesystem::file_size(path, status);
  if (bytes > kLargestPlan && !status) {
    return fail(ErrorCode::kUsage, "{}: larger than {} MiB: that is no plan", path.string(),
                kLargestPlan >> 20);
  }
  std::ifstream file(path, std::ios::binary);
  std::string text(status ? 0 : bytes, '\0');
  if (status || !file.read(text.data(), static_cast<std::streamsize>(bytes)))
    return fail(ErrorCode::kIo, "{}: cannot be read{}: check the path and its permissions",
                path.string(), status ? ": " + status.message() : "");
  return parse_plan(text, path.string(), path.parent_path(), vocabulary);
}

}  // namespace spool
