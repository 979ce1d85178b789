#include "tools/batch/input_files.h"

#include <algorithm>
#include <cstring>
#include <map>
#include <set>
#include <string>
#include <utility>

#include "formats/bounded_json.h"
#include "formats/interchange/sha256.h"
#include "formats/target_watch.h"
#include "lib/image_io/atomic_file.h"
#include "tools/methods/external_methods.h"
#include "tools/methods/replicate_images.h"

namespace spool::tools {
namespace {

namespace fs = std::filesystem;
using nlohmann::ordered_json;

// The words of a shell's line, without its quotes. What is written to by `>` is none of its inputs.
std::vector<std::string> words_of(const std::string& command) {
  std::vector<std::string> words = {""};
  char quote = 0;
  bool written = false;
  for (std::size_t i = 0; i <= command.size(); ++i) {
    const char c = i < command.size() ? command[i] : ' ';
    if (c == quote) {
      quote = 0;
    } else if (quote == 0 && (c == '"' || c == '\'')) {
      quote = c;
    } else if (quote != '\'' && c == '\\' && i + 1 < command.size()) {
      words.back() += command[++i];
    } else if (quote != 0 || !std::strchr(" \t\n;&|()<>", c)) {
      words.back() += c;
    } else {
      if (!words.back().empty()) {
        if (written) words.pop_back();
        written = false;
        words.emplace_back();
      }
      written = written || c == '>';
    }
  }
  return words;
}

bool may_have_files(const MethodChoice& method) {
  return std::ranges::any_of(with_inner_methods(method), [](const MethodChoice& inner) {
    return inner.name == "exec" || inner.name == "counts" || inner.name == "image";
  });
}

// `in_halves`: replicates that are also judged by images of their halves.
std::vector<std::string> files_of(const MethodChoice& method, const Cell& cell, int in_halves) {
  if (method.name == "exec") return words_of(method.preset);
  if (method.name == "counts") return {method.preset};
  if (method.name != "image") return {};
  std::vector<std::string> names = {image_of(cell, method.preset)};
  if (cell.replicate >= in_halves) return names;
  for (const char letter : {'a', 'b', 'c', 'd'}) {
    names.push_back(
        fill_replicate(fill_names(method.preset, cell), std::to_string(cell.replicate) + letter));
  }
  return names;
}

// {path: cells}, of what a chosen cell depends on: the others' results count, too.
std::map<std::string, std::vector<std::size_t>> input_files(const Plan& plan,
                                                            const NamedCells& named,
                                                            const std::vector<bool>& chosen) {
  std::map<std::string, std::vector<std::size_t>> found;
  if (plan.experiment.masks.empty() && std::ranges::none_of(plan.samplers, may_have_files) &&
      std::ranges::none_of(plan.filters, may_have_files))
    return found;  // a plan may have millions of cells
  const int in_halves = plan.experiment.fresh ? plan.replicates : plan.experiment.halves;
  for (std::size_t i = 0; i < named.size(); ++i) {
    const Cell cell = named.cell(i);
    std::set<std::string> names;
    for (const MethodChoice& method : {cell.sampler, cell.filter})
      for (const MethodChoice& inner : with_inner_methods(method))
        for (std::string& name : files_of(inner, cell, in_halves))
          names.insert(std::move(name));
    for (const EnergyMask& mask : plan.experiment.masks)
      names.insert(mask.path);
    for (const std::string& name : names)
      found[name].push_back(i);
  }
  std::error_code status;
  std::erase_if(found, [&](const auto& file) {
    return std::ranges::none_of(file.second, [&](std::size_t i) { return chosen[i]; }) ||
           !fs::is_regular_file(file.first, status);
  });
  return found;
}

ordered_json inputs_of(const fs::path& folder) {
  ordered_json known = format::parse_json_file<ordered_json>(folder / "inputs.json");
  return known.is_object() ? known : ordered_json::object();
}

std::string text_of(const ordered_json& inputs) {
  return inputs.dump(2, ' ', false, ordered_json::error_handler_t::replace) + "\n";
}

// As it was when `entry` was written, by its size and time.
bool is_unchanged(const ordered_json& entry, const ordered_json& now) {
  return entry.is_object() && entry.contains("sha256") && entry["sha256"].is_string() &&
         entry.value("bytes", ordered_json()) == now["bytes"] &&
         entry.value("modified", ordered_json()) == now["modified"];
}

}  // namespace

Result<void> check_input_files(const fs::path& folder, const Plan& plan, const NamedCells& named,
                               const std::vector<bool>& chosen, const CellStore* store) {
  const auto files = input_files(plan, named, chosen);
  if (files.empty()) return {};
  const format::FolderLock shards_beside(folder / "cells");
  ordered_json known = inputs_of(folder);
  const auto has_result = [&](std::size_t i) {
    const auto record = store->read(named.id(i), named.cell(i));
    return record && !record->failed();
  };
  for (const auto& [name, cells] : files) {
    const std::string path = fs::absolute(name).lexically_normal().string();
    std::error_code status;
    ordered_json now = {{"bytes", fs::file_size(path, status)},
                        {"modified", fs::last_write_time(path, status).time_since_epoch().count()}};
    ordered_json& entry = known[path];
    if (is_unchanged(entry, now)) continue;
    SPOOL_ASSIGN(now["sha256"], interchange::sha256_of(path));
    const bool changed = entry.is_object() && entry.value("sha256", now["sha256"]) != now["sha256"];
    if (changed && store == nullptr) {
      return fail(ErrorCode::kUsage,
                  "{}: is another file for a worker than where the run began: give each the same",
                  path);
    }
    if (changed && std::ranges::any_of(cells, has_result)) {
      return fail(ErrorCode::kUsage,
                  "{}: has changed since the results in {} were made: choose another folder or "
                  "give --force",
                  name, folder.string());
    }
    entry = std::move(now);
  }
  return write_text_file(folder / "inputs.json", text_of(known), true, true);
}

Result<std::string> merged_inputs(const fs::path& folder, const std::vector<fs::path>& others) {
  ordered_json known = inputs_of(folder);
  for (const fs::path& other : others) {
    const ordered_json more = inputs_of(other);
    for (const auto& [path, entry] : more.items()) {
      ordered_json& own = known[path];
      if (own.is_null()) own = entry;
      if (!entry.is_object() || !own.is_object() ||
          entry.value("sha256", ordered_json()) == own.value("sha256", ordered_json()))
        continue;
      return fail(ErrorCode::kUsage,
                  "{}: was another file when the results in {} were made: leave this folder out",
                  path, other.string());
    }
  }
  return known.empty() ? std::string() : text_of(known);
}

}  // namespace spool::tools
