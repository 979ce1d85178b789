#include "formats/interchange/npz_export.h"

#include "formats/bounded_json.h"
#include "formats/interchange/export_file.h"
#include "formats/interchange/layer_names.h"
#include "formats/interchange/npy_header.h"
#include "formats/interchange/zip_writer.h"
#include "formats/spool_reader.h"

namespace spool::interchange {
namespace {

using format::FileHandle;
using format::LayerInfo;
using format::Scope;
using format::SpoolReader;
using nlohmann::json;

std::string_view scope_name(Scope scope) {
  return scope == Scope::kPixel ? "pixel" : scope == Scope::kPass ? "pass" : "sample";
}

std::string_view type_code(format::DataType type) {
  return type == format::DataType::kFloat16   ? "<f2"
         : type == format::DataType::kFloat32 ? "<f4"
                                              : "<u4";
}

// The recording's own meta, then what a reader of the arrays must know.
std::string describe(const SpoolReader& dump) {
  json meta = json::object();
  for (const std::string& text : dump.meta())
    meta.update(format::parse_json(text));
  if (!meta.contains("channels") || !meta["channels"].is_object())
    meta["channels"] = json::object();
  meta["scope"] = json::object();
  meta.erase("semantic");
  for (const LayerInfo& layer : dump.layers()) {
    meta["scope"][layer.name] = scope_name(layer.scope);
    if (const auto semantics = own_semantics(dump.header(), layer.name); !semantics.empty())
      meta["semantic"][layer.name] = semantics;
    json& channel = meta["channels"][layer.name];  // an object holds remarks about the layer
    if (channel.is_object())
      channel["components"] = layer.components;
    else
      channel = layer.components;
  }
  meta["spool_npz"] = 1;
  meta["layout"] = "HWSC";
  meta["sample_order"] = dump.header().sample_order == format::SampleOrder::kExchangeable
                             ? "exchangeable"
                             : "renderer";
  meta["pixel_filter"] = "box";
  meta["colour_space"] = "linear_rec709";
  return meta.dump(-1, ' ', false, json::error_handler_t::replace);
}

std::vector<uint64_t> shape_of(const LayerInfo& layer, const SpoolReader& dump) {
  std::vector<uint64_t> shape;
  if (layer.scope != Scope::kPass) shape = {dump.header().height, dump.header().width};
  if (layer.scope != Scope::kPixel) shape.push_back(dump.header().spp);
  if (layer.channel_count > 1) shape.push_back(layer.channel_count);
  return shape;
}

std::span<const std::byte> bytes_of(const std::string& text) {
  return std::as_bytes(std::span(text));
}

Result<ExportReport> export_npz(const std::filesystem::path& in, const std::filesystem::path& out,
                                const ExportOptions& options) {
  SPOOL_ASSIGN(const SpoolReader dump, SpoolReader::open(in));
  if (!dump.complete())
    return fail(ErrorCode::kData, "{}: blocks are missing: an array has no place for holes",
                in.string());
  std::vector<PlannedMember> members;
  std::vector<std::string> starts;  // what stands before the numbers of a member
  const std::string meta = describe(dump);
  const uint64_t meta_bytes[] = {meta.size()};
  starts.push_back(format_npy_header("|u1", meta_bytes) + meta);
  members.push_back({"meta.npy", starts.back().size()});
  for (const LayerInfo& layer : dump.layers()) {
    const auto shape = shape_of(layer, dump);
    uint64_t data = format::bytes_per_value(layer.type);
    for (uint64_t axis : shape)
      data *= axis;  // at most 2^28 * 65536 * 64 * 4 = 2^52
    starts.push_back(format_npy_header(type_code(layer.type), shape));
    members.push_back({layer.name + ".npy", starts.back().size() + data});
  }
  plan_zip(members);
  const auto fill = [&](FileHandle& file) -> Result<void> {
    for (size_t i = 0; i < members.size(); ++i)
      SPOOL_TRY(file.write_at(members[i].data_offset, bytes_of(starts[i])));
    size_t member = 1;
    for (const LayerInfo& layer : dump.layers()) {
      const uint64_t data_offset = members[member].data_offset + starts[member].size();
      SPOOL_TRY(write_layer(dump, layer, layer.type, data_offset, file));
      ++member;
    }
    return finish_zip(file, members);
  };
  SPOOL_TRY(write_whole_file(out, options.force, fill));
  return ExportReport{};
}

}  // namespace

ExportFormat npz_target() {
  return export_format<ExportOptions>("npz", "a file of numpy arrays, bit for bit", {}, export_npz);
}

}  // namespace spool::interchange
