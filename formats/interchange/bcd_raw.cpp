#include "formats/interchange/bcd_raw.h"

#include <array>

#include "formats/byte_io.h"
#include "formats/other_kinds.h"
#include "formats/spool_reader.h"

namespace spool::interchange {
namespace {

using format::FileHandle;
using format::load;
using format::store;

constexpr size_t kHeaderBytes = 20;
constexpr int32_t kVersion = 1;  // it is not checked
enum Field : size_t { kWidth = 4, kHeight = 8, kSamples = 12, kChannels = 16 };

// Bytes in the unit a person would choose.
std::string readable(uint64_t bytes) {
  return bytes < 10'000'000 ? fmt::format("{} bytes", bytes)
                            : fmt::format("{} MB", (bytes + 500'000) / 1'000'000);
}

Result<SampleArray> read_header(const FileHandle& file) {
  const std::string name = file.path().string();
  SPOOL_ASSIGN(const uint64_t bytes, file.size());
  if (bytes < kHeaderBytes)
    return fail(ErrorCode::kDamage, "{}: {} bytes hold no header (byte 0): fetch the file again",
                name, bytes);
  std::array<std::byte, kHeaderBytes> header;
  SPOOL_TRY(file.read_at(0, header));
  const auto field = [&](Field at) { return load<int32_t>(header, at); };
  const auto possible = [&](Field at, uint32_t limit) {
    return field(at) >= 1 && static_cast<uint32_t>(field(at)) <= limit;
  };
  SPOOL_TRY(format::refuse_other_kind(name, header, "a BCD raw file", "give the file of BCD"));
  if (!possible(kWidth, format::kMaxSide) || !possible(kHeight, format::kMaxSide) ||
      !possible(kSamples, format::kMaxSpp) || (field(kChannels) != 3 && field(kChannels) != 4))
    return fail(ErrorCode::kData,
                "{}: header says {}x{}, {} samples, {} channels (byte 4): not a BCD raw file", name,
                field(kWidth), field(kHeight), field(kSamples), field(kChannels));
  SampleArray array{&file, kHeaderBytes, ElementType::kFloat32};
  array.width = static_cast<uint32_t>(field(kWidth));
  array.height = static_cast<uint32_t>(field(kHeight));
  array.samples = static_cast<uint32_t>(field(kSamples));
  array.components = 3;
  array.skipped = static_cast<uint32_t>(field(kChannels)) - 3;
  // At most 2^16 * 2^16 * 2^16 * 2^4: fits 64 bits.
  const uint64_t row = uint64_t{array.width} * array.samples * array.stride() * 4;
  const uint64_t expected = kHeaderBytes + row * array.height;
  const std::string says =
      fmt::format("{}: {}, header says {} ({}x{}, {} samples, {} channels)", name, readable(bytes),
                  readable(expected), array.width, array.height, array.samples, array.stride());
  if (bytes < expected)
    return fail(ErrorCode::kDamage, "{}: cut in row {}", says, (bytes - kHeaderBytes) / row);
  if (bytes > expected) return fail(ErrorCode::kData, "{}: not a BCD raw file", says);
  return array;
}

Result<ImportReport> import_bcd_raw(const std::filesystem::path& in,
                                    const std::filesystem::path& out,
                                    const ImportOptions& options) {
  SPOOL_ASSIGN(const FileHandle file, FileHandle::open(in, format::OpenMode::kRead));
  SPOOL_ASSIGN(const SampleArray array, read_header(file));
  DumpPlan plan;
  plan.width = array.width;
  plan.height = array.height;
  plan.spp = array.samples;
  plan.sample_order = options.sample_order.value_or(format::SampleOrder::kRenderer);
  plan.layers.push_back({"radiance", {"R", "G", "B"}, format::Scope::kSample, array});
  plan.record.format = "bcd-raw";
  plan.record.options = {{"exchangeable", plan.sample_order == format::SampleOrder::kExchangeable}};
  if (array.skipped > 0) plan.record.dropped.push_back("alpha");
  SPOOL_ASSIGN(ForeignFile identity, identify(file));
  plan.record.files.push_back(std::move(identity));
  return write_dump(out, std::move(plan), options);
}

Result<ExportReport> export_bcd_raw(const std::filesystem::path& in,
                                    const std::filesystem::path& out,
                                    const ExportOptions& options) {
  SPOOL_ASSIGN(const format::SpoolReader dump, format::SpoolReader::open(in));
  ExportReport report;
  const format::DumpHeader& header = dump.header();
  const format::LayerInfo radiance = *dump.find_layer("radiance");
  for (uint32_t tile = 0; tile < dump.tiles(); ++tile)
    for (uint32_t block = 0; block < dump.blocks(); ++block)
      if (!dump.has_block(radiance.group, tile, block))
        return fail(ErrorCode::kData,
                    "{}: no radiance in tile {} from sample {}: an array has no place for holes",
                    in.string(), tile, dump.block_begin(block));
  for (const format::LayerInfo& layer : dump.layers())
    if (layer.name != "radiance")
      report.notes.push_back(
          fmt::format("{} is not written: BCD raw holds radiance only", layer.name));
  const auto fill = [&](FileHandle& file) -> Result<void> {
    std::array<std::byte, kHeaderBytes> bytes{};
    store<int32_t>(bytes, 0, kVersion);
    store<int32_t>(bytes, kWidth, static_cast<int32_t>(header.width));
    store<int32_t>(bytes, kHeight, static_cast<int32_t>(header.height));
    store<int32_t>(bytes, kSamples, static_cast<int32_t>(header.spp));
    store<int32_t>(bytes, kChannels, 3);
    SPOOL_TRY(file.write_at(0, bytes));
    return write_layer(dump, radiance, format::DataType::kFloat32, kHeaderBytes, file);
  };
  SPOOL_TRY(write_whole_file(out, options.force, fill));
  return report;
}

}  // namespace

ImportFormat bcd_format() {
  return import_format<ImportOptions>("bcd", "BCD's raw samples: radiance only",
                                      {exchangeable_option<ImportOptions>()}, import_bcd_raw);
}

ExportFormat bcd_target() {
  return export_format<ExportOptions>("bcd", "BCD's raw samples, a file: radiance only", {},
                                      export_bcd_raw);
}

}  // namespace spool::interchange
