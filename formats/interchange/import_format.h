// A foreign format that `spool pack --from` reads, as one value: its name, what it is, its options
// and its importer. The file of a format ends with its value; lib/exchange/foreign_formats.cpp is
// the only list.
#pragma once

#include <filesystem>
#include <functional>
#include <string>
#include <utility>
#include <vector>

#include "formats/interchange/dump_import.h"
#include "lib/core/error.h"
#include "lib/core/option_table.h"

namespace spool::interchange {

struct ImportFormat {
  std::string name;
  std::string summary;
  std::function<std::vector<OptionDescription>()> describe;
  // `common`: what is the same for every format; `set`: options of this one. Errors kUsage for
  // unknown options and wrong values, and those of the importer.
  std::function<Result<ImportReport>(const std::filesystem::path& in,
                                     const std::filesystem::path& out, const ImportOptions& common,
                                     const OptionValues& set)>
      import;
};

// Options: a struct that begins with the common ones.
template <class Options>
ImportFormat import_format(std::string name, std::string summary, OptionTable<Options> table,
                           Result<ImportReport> (*import)(const std::filesystem::path&,
                                                          const std::filesystem::path&,
                                                          const Options&)) {
  ImportFormat format;
  format.name = name;
  format.summary = std::move(summary);
  format.describe = [table] { return describe_options(table, Options{}); };
  format.import = [=](const std::filesystem::path& in, const std::filesystem::path& out,
                      const ImportOptions& common,
                      const OptionValues& set) -> Result<ImportReport> {
    Options start;
    static_cast<ImportOptions&>(start) = common;
    Result<Options> options = with_options(table, std::move(start), set);
    if (!options) {
      return fail(options.error().code, "import {}: {}", name, options.error().message);
    }
    return import(in, out, *options);
  };
  return format;
}

// Of formats that do not say in which order the samples of a pixel come.
template <class Options>
Option<Options> exchangeable_option() {
  return {"exchangeable", "on|off", "the samples of a pixel come in no meaningful order",
          [](Options& options, std::string_view text) -> Result<void> {
            if (text != "on" && text != "off") {
              return fail(ErrorCode::kUsage, "option exchangeable: '{}' is not one of on|off",
                          text);
            }
            options.sample_order.reset();
            if (text == "on") options.sample_order = format::SampleOrder::kExchangeable;
            return {};
          },
          [](const Options& options) -> std::string {
            return options.sample_order == format::SampleOrder::kExchangeable ? "on" : "off";
          }};
}

// A choice that may be left open; `open` is its word.
template <class Options, class Enum>
Option<Options> open_choice_option(std::string name, std::optional<Enum> Options::* member,
                                   std::string open,
                                   std::vector<std::pair<std::string, Enum>> choices,
                                   std::string help) {
  std::string allowed = open;
  for (const auto& choice : choices)
    allowed += "|" + choice.first;
  return {name, allowed, std::move(help),
          [=](Options& options, std::string_view text) -> Result<void> {
            (options.*member).reset();
            if (text == open) return {};
            for (const auto& [word, value] : choices) {
              if (word != text) continue;
              options.*member = value;
              return {};
            }
            return fail(ErrorCode::kUsage, "option {}: '{}' is not one of {}", name, text, allowed);
          },
          [=](const Options& options) -> std::string {
            for (const auto& [word, value] : choices) {
              if (options.*member == value) return word;
            }
            return open;
          }};
}

}  // namespace spool::interchange
