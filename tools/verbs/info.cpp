#include "tools/verbs/info.h"

#include <algorithm>
#include <iterator>

#include <nlohmann/json.hpp>

#include "formats/interchange/sha256.h"
#include "lib/core/counted.h"
#include "lib/core/visible_text.h"
#include "tools/batch/dump_meta.h"
#include "tools/json/json_text.h"

namespace spool::tools {
namespace {

using nlohmann::ordered_json;

constexpr std::size_t kLongestRemark = 100;  // bytes, in the listing

std::string hex(const std::array<std::uint8_t, 16>& bytes) {
  std::string text;
  for (const std::uint8_t byte : bytes)
    text += fmt::format("{:02x}", byte);
  return text;
}

ordered_json describe(const format::SpoolReader& reader, std::uintmax_t bytes,
                      const std::string& sha256, const std::string& index_sha256) {
  const format::DumpHeader& header = reader.header();
  ordered_json layers = ordered_json::array();
  for (const format::LayerInfo& layer : reader.layers()) {
    layers.push_back({{"name", layer.name},
                      {"components", layer.components},
                      {"type", format::kDataTypeNames[static_cast<std::size_t>(layer.type)]},
                      {"scope", format::kScopeNames[static_cast<std::size_t>(layer.scope)]},
                      {"group", layer.group}});
  }
  const ordered_json meta = merged_meta(reader);
  ordered_json out = {
      {"file", reader.path().string()},
      {"bytes", bytes},
      {"sha256", sha256},
      {"index_sha256", index_sha256},
      {"uuid", hex(header.uuid)},
      {"width", header.width},
      {"height", header.height},
      {"samples_per_pixel", header.spp},
      {"sample_order",
       header.sample_order == format::SampleOrder::kExchangeable ? "exchangeable" : "renderer"},
      {"complete", reader.complete()},
      {"tile_size", header.tile_size},
      {"samples_per_block", header.block_spp},
      {"layers", layers},
      {"reference", reader.find_layer("reference").has_value()},
      {"reference_variance", reader.find_layer("reference_variance").has_value()}};
  out["verified"] = nullptr;  // or what dumps/verify said of all claims together
  const auto verification = meta.find("verification");
  if (verification != meta.end() && verification->is_object()) {
    const ordered_json holds = verification->value("holds", ordered_json(nullptr));
    if (holds.is_boolean()) out["verified"] = holds;
  }
  const std::optional<double> cost = cost_per_sample(meta);
  out["cost_per_sample"] = cost ? ordered_json(*cost) : ordered_json(nullptr);
  out["meta"] = meta;
  return out;
}

// A value of the remarks in one line, or empty: an object as "name value, name value", a list as
// "value, value".
// `brief`: without the names of names and without sums.
std::string remark(const ordered_json& info, const char* key, bool brief = false) {
  const auto found = info["meta"].find(key);
  if (found == info["meta"].end()) return {};
  const auto plain = [](const ordered_json& value) {
    return value.is_string() ? value.get<std::string>() : value.dump();
  };
  std::string text;
  if (found->is_object()) {
    for (const auto& [name, value] : found->items()) {
      if (value.is_structured() || (brief && name == "sha256")) continue;
      text +=
          (text.empty() ? "" : ", ") + (brief && name == "name" ? "" : name + " ") + plain(value);
    }
  } else if (found->is_array()) {
    for (const ordered_json& value : *found)
      text += (text.empty() ? "" : ", ") + plain(value);
  } else {
    text = plain(*found);
  }
  if (text.size() <= kLongestRemark) return text;
  return text.substr(0, start_of_character(text, kLongestRemark - 3)) + "...";
}

std::string text_of(const ordered_json& object, const char* key) {
  const auto found = object.find(key);
  if (found == object.end()) return {};
  return found->is_string() ? found->get<std::string>() : found->dump();
}

// What dumps/verify found, one row per claim; a foreign `verification` shows what it has.
void add_verification(const ordered_json& meta, std::vector<std::vector<std::string>>& rows) {
  const auto found = meta.find("verification");
  if (found == meta.end() || !found->is_object()) {
    rows.push_back({"verified", "no: dumps/verify/verify.py FILE --write tests the samples"});
    return;
  }
  unsigned holding = 0, failing = 0, unknown = 0;
  std::vector<std::vector<std::string>> claims;
  const ordered_json findings = found->value("findings", ordered_json::array());
  for (const ordered_json& claim : findings) {
    if (!claim.is_object()) continue;
    const ordered_json holds = claim.value("holds", ordered_json(nullptr));
    ++(!holds.is_boolean() ? unknown : holds.get<bool>() ? holding : failing);
    const std::string verdict = !holds.is_boolean() ? "not known"
                                : holds.get<bool>() ? "holds"
                                                    : "FAILS";
    const auto p = claim.find("p_value");
    claims.push_back(
        {"claim", fmt::format("{} {}: {}, expected {}{}", text_of(claim, "name"), verdict,
                              text_of(claim, "measured"), text_of(claim, "expected"),
                              p != claim.end() && p->is_number()
                                  ? fmt::format(", p = {:.2g}", p->get<double>())
                                  : std::string())});
  }
  const ordered_json whole = found->value("holds", ordered_json(nullptr));
  const bool fails = failing > 0 || whole == ordered_json(false);
  const char* verdict = fails ? "FAILS" : holding > 0 ? "yes" : "not known";
  rows.push_back({"verified",
                  fmt::format("{}: {}{}{}", verdict, counted(holding, "claim holds", "claims hold"),
                              failing > 0 ? ", " + counted(failing, "fails", "fail") : "",
                              unknown > 0 ? fmt::format(", {} not known", unknown) : "")});
  rows.insert(rows.end(), claims.begin(), claims.end());
}

// What may be said of a pixel's samples; foreign files do not contain whether they are independent.
std::string describe_order(const ordered_json& info) {
  if (info["sample_order"] != "exchangeable") return "in renderer order";
  const auto import = info["meta"].find("import");
  if (import == info["meta"].end() || !import->is_object()) return "exchangeable (independent)";
  const ordered_json independent = import->value("independent", ordered_json("unknown"));
  return independent == true ? "exchangeable (independent)"
                             : "exchangeable (not known to be independent)";
}

std::string reference_text(const ordered_json& info) {
  if (!info["reference"].get<bool>()) return "none recorded";
  return info["reference_variance"].get<bool>() ? "recorded, with its variance"
                                                : "recorded, without variance";
}

std::string samples_text(const ordered_json& info) {
  return fmt::format("{} per pixel, {}{}", info["samples_per_pixel"].get<unsigned>(),
                     describe_order(info), info["complete"].get<bool>() ? "" : ", INCOMPLETE");
}

void add_remarks(const ordered_json& meta, std::vector<std::vector<std::string>>& rows) {
  const auto remarks = meta.find("import_remarks");
  if (remarks == meta.end() || !remarks->is_array()) return;
  for (const auto& text : *remarks)
    rows.push_back({"remark", text.is_string() ? text.get<std::string>() : text.dump()});
}

// A line for each thing that one asks first.
std::vector<std::vector<std::string>> short_rows_of(const ordered_json& info) {
  std::vector<std::vector<std::string>> rows;
  rows.push_back({"file", fmt::format("{}, {}", info["file"].get<std::string>(),
                                      format_bytes(info["bytes"].get<double>()))});
  rows.push_back({"image", fmt::format("{} x {} pixels", info["width"].get<unsigned>(),
                                       info["height"].get<unsigned>())});
  rows.push_back({"samples", samples_text(info)});
  std::string layers;
  for (const auto& layer : info["layers"]) {
    if (layer["scope"] == "pixel") continue;
    layers += (layers.empty() ? "" : ", ") + layer["name"].get<std::string>();
  }
  rows.push_back({"layers", layers});
  rows.push_back({"reference", reference_text(info)});
  std::string renderer;
  for (const char* key : {"renderer", "version", "scene", "mode"}) {
    const std::string text = remark(info, key, true);
    const bool named = key == std::string_view("scene") || key == std::string_view("mode");
    if (!text.empty())
      renderer += (renderer.empty() ? ""
                   : named          ? ", "
                                    : " ") +
                  (named ? key + (" " + text) : text);
  }
  if (!renderer.empty()) rows.push_back({"renderer", renderer});
  if (!info["cost_per_sample"].is_null()) {
    rows.push_back({"cost", format_seconds(info["cost_per_sample"].get<double>()) + " per sample"});
  }
  add_remarks(info["meta"], rows);
  std::vector<std::vector<std::string>> verification;
  add_verification(info["meta"], verification);
  for (const auto& row : verification) {
    const bool failing = row[0] == "claim" && row[1].find(" FAILS: ") != std::string::npos;
    if (row[0] != "claim" || failing) rows.push_back(row);
  }
  return rows;
}

std::vector<std::vector<std::string>> rows_of(const ordered_json& info) {
  std::vector<std::vector<std::string>> rows;
  rows.push_back({"file", info["file"].get<std::string>()});
  rows.push_back({"size", format_bytes(info["bytes"].get<double>())});
  rows.push_back({"sha256", info["sha256"].get<std::string>()});
  rows.push_back({"of its index", info["index_sha256"].get<std::string>()});
  rows.push_back({"image", fmt::format("{} x {} pixels", info["width"].get<unsigned>(),
                                       info["height"].get<unsigned>())});
  rows.push_back({"samples", samples_text(info)});
  for (const auto& layer : info["layers"]) {
    std::string components;
    for (const auto& component : layer["components"]) {
      components += (components.empty() ? "" : " ") + component.get<std::string>();
    }
    rows.push_back({"channel", fmt::format("{} ({})  {} per {}", layer["name"].get<std::string>(),
                                           components, layer["type"].get<std::string>(),
                                           layer["scope"].get<std::string>())});
  }
  rows.push_back({"reference", reference_text(info)});
  rows.push_back(
      {"cost", info["cost_per_sample"].is_null()
                   ? "not recorded"
                   : format_seconds(info["cost_per_sample"].get<double>()) + " per sample"});
  for (const char* key : {"renderer", "version", "scene", "mode", "seed", "seeds"}) {
    const std::string text = remark(info, key);
    if (!text.empty()) rows.push_back({key, text});
  }
  add_remarks(info["meta"], rows);
  add_verification(info["meta"], rows);
  return rows;
}

}  // namespace

Result<std::vector<std::vector<std::string>>> recording_facts(const std::filesystem::path& path) {
  SPOOL_ASSIGN(const format::SpoolReader reader, format::SpoolReader::open(path));
  std::error_code status;
  const std::uintmax_t bytes = std::filesystem::file_size(path, status);
  const ordered_json info = describe(reader, bytes, "", "");
  std::vector<std::vector<std::string>> rows = short_rows_of(info), claims;
  std::erase_if(rows, [](const auto& row) { return row[0] == "claim"; });  // the failing ones
  add_verification(info["meta"], claims);
  std::ranges::copy_if(claims, std::back_inserter(rows),
                       [](const auto& row) { return row[0] == "claim"; });
  return rows;
}

Result<void> run_info(const InfoOptions& options, const CommonOptions& common) {
  SPOOL_ASSIGN(const format::SpoolReader reader, format::SpoolReader::open(options.dump));
  std::error_code status;
  const std::uintmax_t bytes = std::filesystem::file_size(options.dump, status);
  std::string sha256, index_sha256;
  if (common.json || options.all) {
    SPOOL_ASSIGN(sha256, interchange::sha256_of(options.dump));
    SPOOL_ASSIGN(index_sha256, interchange::index_sha256_of(options.dump));
  }
  const ordered_json info = describe(reader, bytes, sha256, index_sha256);
  if (common.json) {
    print(json_text(info));
  } else if (options.all) {
    print(format_columns(rows_of(info), 2));
  } else {
    print(format_columns(short_rows_of(info), 2) + "all of it: --all\n");
  }
  return {};
}

}  // namespace spool::tools
