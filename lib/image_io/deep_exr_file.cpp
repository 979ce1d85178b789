#include "lib/image_io/deep_exr_file.h"

#include <exception>
#include <optional>

#include <OpenEXR/ImfChannelList.h>
#include <OpenEXR/ImfDeepFrameBuffer.h>
#include <OpenEXR/ImfDeepScanLineInputPart.h>
#include <OpenEXR/ImfDeepScanLineOutputFile.h>
#include <OpenEXR/ImfMultiPartInputFile.h>
#include <OpenEXR/ImfPartType.h>

#include "lib/core/visible_text.h"
#include "lib/image_io/atomic_file.h"
#include "lib/image_io/exr_geometry.h"
#include "lib/image_io/exr_header_scan.h"
#include "lib/image_io/exr_output.h"

namespace spool {
namespace {

// A pointer array whose entry for pixel x of any row is base[x]: rows are handled one at a time.
Imf::DeepSlice row_slice(PixelType type, std::vector<char*>& pointers, int x0) {
  char* base = reinterpret_cast<char*>(pointers.data() - x0);
  return {exr::imf_type(type), base, sizeof(char*), 0, bytes_per_value(type)};
}

Imf::Slice count_slice(std::vector<std::uint32_t>& counts, int x0) {
  return {Imf::UINT, reinterpret_cast<char*>(counts.data() - x0), sizeof(std::uint32_t), 0};
}

}  // namespace

struct DeepExrReader::State {
  State(const std::filesystem::path& path, std::uint64_t bytes, const DeepReadLimits& caps)
      : name(path.string()), file_bytes(bytes), limits(caps), input(path.c_str(), 0, false) {}

  std::string name;
  std::uint64_t file_bytes;
  DeepReadLimits limits;
  Imf::MultiPartInputFile input;
  std::optional<Imf::DeepScanLineInputPart> part;
  DeepHeader header;
  int x0 = 0, y0 = 0;

  Result<DeepRow> read(int y) {
    DeepRow row;
    row.counts.resize(static_cast<std::size_t>(header.width));
    std::vector<std::vector<char*>> pointers(header.channels.size(),
                                             std::vector<char*>(row.counts.size()));
    Imf::DeepFrameBuffer buffer;
    buffer.insertSampleCountSlice(count_slice(row.counts, x0));
    for (std::size_t c = 0; c < pointers.size(); ++c)
      buffer.insert(header.channels[c].name, row_slice(header.channels[c].type, pointers[c], x0));
    part->setFrameBuffer(buffer);
    part->readPixelSampleCounts(y0 + y, y0 + y);
    std::uint64_t samples = 0, sample_bytes = 0;  // 2^20 pixels of 2^32 samples fit
    for (const std::uint32_t count : row.counts)
      samples += count;
    for (const ExrChannel& channel : header.channels)
      sample_bytes += bytes_per_value(channel.type);
    if (samples > limits.max_row_bytes / sample_bytes ||
        samples * sample_bytes / exr::kMaxExpansion > file_bytes)
      return fail(ErrorCode::kDamage,
                  "{}: row {} claims {} samples in a file of {} bytes: it is damaged or too large",
                  name, y, samples, file_bytes);
    for (std::size_t c = 0; c < pointers.size(); ++c) {
      const std::size_t bytes = bytes_per_value(header.channels[c].type);
      auto& values = row.values.emplace_back(samples * bytes);
      std::size_t at = 0;
      for (std::size_t x = 0; x < row.counts.size(); ++x) {
        pointers[c][x] = reinterpret_cast<char*>(values.data()) + at;
        at += row.counts[x] * bytes;
      }
    }
    part->readPixels(y0 + y, y0 + y);
    return row;
  }
};

DeepExrReader::DeepExrReader(std::unique_ptr<State> state) : state_(std::move(state)) {}
DeepExrReader::DeepExrReader(DeepExrReader&&) noexcept = default;
DeepExrReader& DeepExrReader::operator=(DeepExrReader&&) noexcept = default;
DeepExrReader::~DeepExrReader() = default;

Result<DeepExrReader> DeepExrReader::open(const std::filesystem::path& path,
                                          const DeepReadLimits& limits) {
  const std::string name = path.string();
  SPOOL_ASSIGN(const std::uint64_t file_bytes, exr::scan_headers(path));
  try {
    exr::cap_sizes();
    auto state = std::make_unique<State>(path, file_bytes, limits);
    const Imf::Header& header = state->input.header(0);
    if (!header.hasType() || header.type() != Imf::DEEPSCANLINE)
      return fail(ErrorCode::kData, "{}: part 0 is '{}': deep scanlines are needed", name,
                  header.hasType() ? printable_ascii(header.type()) : "flat");
    SPOOL_ASSIGN(const exr::Window window, exr::checked_window(name, header, limits.max_pixels));
    // The table of samples alone takes four bytes a pixel, before any of them is read.
    const auto pixels =
        static_cast<std::uint64_t>(window.width) * static_cast<std::uint64_t>(window.height);
    SPOOL_ASSIGN(state->header.channels, exr::checked_channels(name, header));
    for (const ExrChannel& channel : state->header.channels)
      SPOOL_TRY(exr::check_full_size(name, channel));
    SPOOL_TRY(exr::check_claim(name, window, 1, 4 * pixels, UINT64_MAX, file_bytes));
    state->header.width = window.width;
    state->header.height = window.height;
    state->x0 = header.dataWindow().min.x;
    state->y0 = header.dataWindow().min.y;
    exr::read_attributes(header, state->header.attributes);
    state->part.emplace(state->input, 0);
    return DeepExrReader(std::move(state));
  } catch (const std::exception& error) {
    return fail(ErrorCode::kDamage, "{}: the EXR is cut or damaged ({})", name,
                printable_ascii(error.what()));
  }
}

const DeepHeader& DeepExrReader::header() const {
  return state_->header;
}

Result<DeepRow> DeepExrReader::read_row(int y) {
  try {
    return state_->read(y);
  } catch (const std::exception& error) {
    return fail(ErrorCode::kDamage, "{}: the EXR is cut or damaged in row {} ({})", state_->name, y,
                printable_ascii(error.what()));
  }
}

struct DeepExrWriter::State {
  State(AtomicFile atomic, const DeepHeader& about, std::uint32_t count)
      : file(std::move(atomic)), header(about), samples(count) {}

  AtomicFile file;
  DeepHeader header;
  std::uint32_t samples;
  exr::ExrOutput stream{file.file()};
  std::optional<Imf::DeepScanLineOutputFile> output;  // before the stream goes

  Imf::Header imf_header() const {
    Imf::Header made(header.width, header.height);
    made.setType(Imf::DEEPSCANLINE);
    made.compression() = Imf::ZIPS_COMPRESSION;
    for (const ExrChannel& channel : header.channels)
      made.channels().insert(channel.name, Imf::Channel(exr::imf_type(channel.type)));
    exr::write_attributes(header.attributes, made);
    return made;
  }

  void write(const std::vector<std::vector<std::byte>>& values) {
    std::vector<std::uint32_t> counts(static_cast<std::size_t>(header.width), samples);
    std::vector<std::vector<char*>> pointers(values.size(), std::vector<char*>(counts.size()));
    Imf::DeepFrameBuffer buffer;
    buffer.insertSampleCountSlice(count_slice(counts, 0));
    for (std::size_t c = 0; c < values.size(); ++c) {
      const std::size_t pixel = bytes_per_value(header.channels[c].type) * samples;
      // OpenEXR takes a pointer it may write through, and does not.
      auto* bytes = const_cast<char*>(reinterpret_cast<const char*>(values[c].data()));
      for (std::size_t x = 0; x < counts.size(); ++x)
        pointers[c][x] = bytes + x * pixel;
      buffer.insert(header.channels[c].name, row_slice(header.channels[c].type, pointers[c], 0));
    }
    output->setFrameBuffer(buffer);
    output->writePixels(1);
  }
};

DeepExrWriter::DeepExrWriter(std::unique_ptr<State> state) : state_(std::move(state)) {}
DeepExrWriter::DeepExrWriter(DeepExrWriter&&) noexcept = default;
DeepExrWriter::~DeepExrWriter() = default;

Result<DeepExrWriter> DeepExrWriter::create(const std::filesystem::path& path,
                                            const DeepHeader& header, std::uint32_t samples,
                                            bool overwrite) {
  SPOOL_ASSIGN(AtomicFile file, AtomicFile::create(path, overwrite));
  auto state = std::make_unique<State>(std::move(file), header, samples);
  try {
    state->output.emplace(state->stream, state->imf_header());
  } catch (const std::exception& error) {
    return fail(ErrorCode::kIo, "{}: cannot be written ({}): nothing was changed", path.string(),
                printable_ascii(error.what()));
  }
  return DeepExrWriter(std::move(state));
}

Result<void> DeepExrWriter::write_row(const std::vector<std::vector<std::byte>>& values) {
  try {
    state_->write(values);
    return {};
  } catch (const std::exception& error) {
    return fail(ErrorCode::kIo, "{}: cannot be written ({}): free some space",
                state_->file.temporary_path().string(), printable_ascii(error.what()));
  }
}

Result<void> DeepExrWriter::finish() {
  try {
    state_->output.reset();
  } catch (const std::exception& error) {
    return fail(ErrorCode::kIo, "{}: cannot be written ({}): free some space",
                state_->file.temporary_path().string(), printable_ascii(error.what()));
  }
  SPOOL_TRY(state_->stream.finished());
  return state_->file.commit();
}

}  // namespace spool
