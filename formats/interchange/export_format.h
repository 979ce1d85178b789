// A foreign format that `spool convert --to` writes, as one value: its name, what it is, its
// options and its exporter. The file of a format ends with its value;
// lib/exchange/foreign_formats.cpp is the only list.
#pragma once

#include <filesystem>
#include <functional>
#include <string>
#include <utility>
#include <vector>

#include "formats/interchange/export_file.h"
#include "formats/target_watch.h"
#include "lib/core/error.h"
#include "lib/core/option_table.h"

namespace spool::interchange {

// What is the same for every format.
struct ExportOptions {
  bool force = false;  // replace what is there
};

struct ExportFormat {
  std::string name;
  std::string summary;
  std::function<std::vector<OptionDescription>()> describe;
  // `set`: options of this format. Errors kUsage for unknown options and wrong values, and those of
  // the exporter.
  std::function<Result<ExportReport>(const std::filesystem::path& in,
                                     const std::filesystem::path& out, const ExportOptions& common,
                                     const OptionValues& set)>
      write;
};

// Options: a struct that begins with the common ones.
template <class Options>
ExportFormat export_format(std::string name, std::string summary, OptionTable<Options> table,
                           Result<ExportReport> (*write)(const std::filesystem::path&,
                                                         const std::filesystem::path&,
                                                         const Options&)) {
  ExportFormat made;
  made.name = name;
  made.summary = std::move(summary);
  made.describe = [table] { return describe_options(table, Options{}); };
  made.write = [=](const std::filesystem::path& in, const std::filesystem::path& out,
                   const ExportOptions& common, const OptionValues& set) -> Result<ExportReport> {
    Options start;
    static_cast<ExportOptions&>(start) = common;
    Result<Options> options = with_options(table, std::move(start), set);
    if (!options) {
      return fail(options.error().code, "export {}: {}", name, options.error().message);
    }
    SPOOL_TRY(format::refuse_own_input(out, in));
    return write(in, out, *options);
  };
  return made;
}

// Any text: the name of a file, of an image.
template <class Options>
Option<Options> text_option(std::string name, std::string Options::* member, std::string allowed,
                            std::string help) {
  return {std::move(name), std::move(allowed), std::move(help),
          [=](Options& options, std::string_view text) -> Result<void> {
            options.*member = text;
            return {};
          },
          [=](const Options& options) { return options.*member; }};
}

}  // namespace spool::interchange
