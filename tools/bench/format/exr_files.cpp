#include "tools/bench/format/exr_files.h"

#include <fmt/core.h>

#include <OpenEXR/ImfChannelList.h>
#include <OpenEXR/ImfDeepFrameBuffer.h>
#include <OpenEXR/ImfDeepScanLineInputFile.h>
#include <OpenEXR/ImfDeepScanLineOutputFile.h>
#include <OpenEXR/ImfFrameBuffer.h>
#include <OpenEXR/ImfInputFile.h>
#include <OpenEXR/ImfOutputFile.h>
#include <OpenEXR/ImfPartType.h>

namespace spool::bench {
namespace {

Imf::PixelType imf_type(const SampleChannel& channel) {
  return channel.about.type == format::DataType::kFloat16 ? Imf::HALF : Imf::FLOAT;
}

Imf::Header header_of(const RecordedSamples& samples, Imf::Compression compression) {
  Imf::Header header(static_cast<int>(samples.width), static_cast<int>(samples.height));
  header.compression() = compression;
  for (const SampleChannel& channel : samples.channels)
    header.channels().insert(channel.about.name, Imf::Channel(imf_type(channel)));
  return header;
}

// Where the samples of each pixel begin, and how many they are: for OpenEXR's deep frame buffer.
struct DeepTables {
  std::vector<uint32_t> counts;              // [y][x]
  std::vector<std::vector<char*>> pointers;  // [c][y][x]
  Imf::DeepFrameBuffer buffer;

  explicit DeepTables(RecordedSamples& samples)
      : counts(size_t{samples.width} * samples.height, samples.spp),
        pointers(samples.channels.size(), std::vector<char*>(counts.size())) {
    const size_t row = samples.width;
    buffer.insertSampleCountSlice(Imf::Slice(Imf::UINT, reinterpret_cast<char*>(counts.data()),
                                             sizeof(uint32_t), sizeof(uint32_t) * row));
    for (size_t c = 0; c < pointers.size(); ++c) {
      SampleChannel& channel = samples.channels[c];
      for (size_t i = 0; i < counts.size(); ++i)
        pointers[c][i] = reinterpret_cast<char*>(channel.values.data()) +
                         i * samples.spp * channel.value_bytes();
      buffer.insert(channel.about.name,
                    Imf::DeepSlice(imf_type(channel), reinterpret_cast<char*>(pointers[c].data()),
                                   sizeof(char*), sizeof(char*) * row, channel.value_bytes()));
    }
  }
};

Imf::FrameBuffer image_of_sample(RecordedSamples& samples, uint32_t s) {
  Imf::FrameBuffer buffer;
  for (SampleChannel& channel : samples.channels) {
    const size_t pixel = channel.value_bytes() * samples.spp;
    char* base = reinterpret_cast<char*>(channel.values.data()) + s * channel.value_bytes();
    buffer.insert(channel.about.name,
                  Imf::Slice(imf_type(channel), base, pixel, pixel * samples.width));
  }
  return buffer;
}

std::string image_name(const std::filesystem::path& folder, uint32_t s) {
  return (folder / fmt::format("sample_{:04}.exr", s)).string();
}

}  // namespace

void write_deep_exr(const std::filesystem::path& path, RecordedSamples& samples) {
  Imf::Header header = header_of(samples, Imf::ZIPS_COMPRESSION);
  header.setType(Imf::DEEPSCANLINE);
  DeepTables tables(samples);
  Imf::DeepScanLineOutputFile file(path.c_str(), header, 0);
  file.setFrameBuffer(tables.buffer);
  file.writePixels(static_cast<int>(samples.height));
}

void read_deep_exr(const std::filesystem::path& path, RecordedSamples& into) {
  DeepTables tables(into);
  Imf::DeepScanLineInputFile file(path.c_str(), 0);
  file.setFrameBuffer(tables.buffer);
  const int last = static_cast<int>(into.height) - 1;
  file.readPixelSampleCounts(0, last);
  file.readPixels(0, last);
}

void write_flat_exr(const std::filesystem::path& folder, RecordedSamples& samples, bool zip) {
  std::filesystem::create_directories(folder);
  const Imf::Header header = header_of(samples, zip ? Imf::ZIP_COMPRESSION : Imf::NO_COMPRESSION);
  for (uint32_t s = 0; s < samples.spp; ++s) {
    Imf::OutputFile file(image_name(folder, s).c_str(), header, 0);
    file.setFrameBuffer(image_of_sample(samples, s));
    file.writePixels(static_cast<int>(samples.height));
  }
}

void read_flat_exr(const std::filesystem::path& folder, RecordedSamples& into) {
  for (uint32_t s = 0; s < into.spp; ++s) {
    Imf::InputFile file(image_name(folder, s).c_str(), 0);
    file.setFrameBuffer(image_of_sample(into, s));
    file.readPixels(0, static_cast<int>(into.height) - 1);
  }
}

}  // namespace spool::bench
