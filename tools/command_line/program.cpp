#include "tools/command_line/program.h"

#include <algorithm>
#include <cctype>
#include <charconv>
#include <cstdint>
#include <limits>
#include <map>

#include "lib/core/option_table.h"

namespace spool::tools {
namespace {

// CLI11 itself reads whole numbers as C does: 010 as 8, 0x10 as 16.
std::string in_decimal(std::string& text) {
  constexpr double kAny = std::numeric_limits<double>::infinity();
  if (!parse_number("", text, -kAny, kAny)) return "is no number";  // misspelt.h words it
  const std::size_t sign = text.starts_with('-') ? 1 : 0;
  std::size_t zeros = 0;
  while (text[sign + zeros] == '0' && std::isdigit(text[sign + zeros + 1]))
    ++zeros;
  text.erase(sign, zeros);
  return "";
}

}  // namespace

std::string empty_option(const CLI::App& verb) {
  for (const CLI::Option* option : verb.get_options())
    if (std::ranges::count(option->results(), "") > 0) return option->get_name();
  return "";
}

void add_common(CLI::App& verb, CommonOptions& common, bool json, bool force) {
  constexpr const char* kGroup = "Common";
  verb.get_help_ptr()->group(kGroup);
  if (json) verb.add_flag("--json", common.json, "print JSON instead of text")->group(kGroup);
  if (force) verb.add_flag("--force", common.force, "replace what exists")->group(kGroup);
  verb.add_flag("--quiet,-q", common.quiet, "no progress, no remarks")->group(kGroup);
  within(verb.add_option("--threads", common.threads,
                         "threads to use, 0 for all; the results do not depend on it"),
         kThreads)
      ->group(kGroup);
}

void group_options(CLI::App& verb, const char* group, std::initializer_list<const char*> options) {
  for (const char* option : options)
    verb.get_option(option)->group(group);
}

CLI::Option* within(CLI::Option* option, const Bounds& bounds) {
  return option->transform(CLI::Validator(in_decimal, ""))
      ->type_name(number_range(bounds.lowest, bounds.highest));
}

CLI::Option* repeatable(CLI::Option* option) {
  return option->take_all()->allow_extra_args(false);
}

// "TEXT:{shared,exact}", "{label->0,name->1} OR {0,1}" and "recorded|shuffled" say all values.
std::vector<std::string> written_choices(const CLI::Option& option) {
  const std::string type = option.get_type_name();
  const std::string& shown = option.get_option_text();
  const std::size_t open = type.find('{'), close = type.find('}');
  std::string listed;
  if (open != std::string::npos && close > open) listed = type.substr(open + 1, close - open - 1);
  if (shown.find('|') != std::string::npos) listed = shown;
  std::ranges::replace(listed, '|', ',');
  std::vector<std::string> choices = split_list(listed);
  for (std::string& choice : choices)
    choice.resize(std::min(choice.find("->"), choice.size()));
  return choices;
}

// CLI11 itself wraps what is negative, and takes 010 for 8.
CLI::Validator seed_check() {
  return CLI::Validator(
      [](std::string& text) -> std::string {
        std::int64_t seed = -1;
        const char* end = text.data() + text.size();
        const auto parsed = std::from_chars(text.data(), end, seed);
        if (parsed.ec != std::errc() || parsed.ptr != end || seed < 0)
          return fmt::format("a seed is a whole number from 0 to {}, not {}",
                             std::numeric_limits<std::int64_t>::max(), text);
        text = std::to_string(seed);
        return "";
      },
      "");
}

void add_dump(CLI::App& verb, std::filesystem::path& dump) {
  verb.add_option("FILE", dump, "a recording, NAME.spool")->required();
}

void add_output(CLI::App& verb, std::filesystem::path& output, const std::string& help) {
  verb.add_option("-o,--output", output, help)->required();
}

void add_layer(CLI::App& verb, LayerChoice& choice, const std::string& before,
               const std::string& whose) {
  verb.add_option("--" + before + "layer", choice.layer,
                  fmt::format("the layer {} that is the picture, where several may be", whose));
  verb.add_option("--" + before + "part", choice.part,
                  fmt::format("the part {} that has it, by name or number", whose));
}

void add_method(CLI::App& verb, MethodOptions& method) {
  verb.add_option("--preset", method.preset,
                  "values of all options at once: see spool list presets");
  repeatable(verb.add_option(
      "--set", method.settings,
      "PART.OPTION=VALUE; PART is sampler, filter or the name of one method (spool list METHOD), "
      "pool (spool list pool), or, of evaluate, metrics (spool list metrics); may be given several "
      "times"));
  group_options(verb, "Options of the method", {"--preset", "--set"});
}

CLI::Option* add_order(CLI::App& verb, PoolOrder& order) {
  return verb
      .add_option("--order", order,
                  "order of each pixel's samples: recorded (default) or shuffled by --seed")
      ->transform(CLI::CheckedTransformer(
                      std::map<std::string, PoolOrder>{{"recorded", PoolOrder::kRecorded},
                                                       {"shuffled", PoolOrder::kShuffled}})
                      .description(""))
      ->option_text("recorded|shuffled");
}

void add_pool(CLI::App& verb, PoolOptions& pool) {
  add_order(verb, pool.order);
  verb.add_option("--seed", pool.seed, "seed of the order and of the method (0)")
      ->transform(seed_check());
  within(verb.add_option("--holdout", pool.holdout, "samples per pixel that are never offered (0)"),
         kHoldout);
  within(verb.add_option("--pieces", pool.pieces_per_side, kPieces), kPiecesPerSide);
  group_options(verb, "Samples", {"--order", "--seed", "--holdout", "--pieces"});
}

}  // namespace spool::tools
