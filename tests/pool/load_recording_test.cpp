#include "lib/pool/load_recording.h"

#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <limits>
#include <span>
#include <tuple>

#include <gtest/gtest.h>

#include "formats/spool_writer.h"
#include "lib/core/parallel.h"
#include "lib/synthetic/scene_s.h"
#include "lib/synthetic/write_synthetic.h"
#include "tests/support/scratch_folder.h"

namespace spool {
namespace {

using test::ScratchFolder;

// Of every `step`-th row and column.
void expect_same_samples(const RecordedSamples& a, const RecordedSamples& b, int step = 1) {
  ASSERT_EQ(a.width(), b.width());
  ASSERT_EQ(a.height(), b.height());
  ASSERT_EQ(a.spp(), b.spp());
  for (int y = 0; y < a.height(); y += step) {
    for (int x = 0; x < a.width(); x += step) {
      for (int s = 0; s < a.spp(); ++s) {
        ASSERT_EQ(a.radiance(x, y, s), b.radiance(x, y, s)) << x << "," << y << "," << s;
        ASSERT_EQ(a.film(x, y, s).x, b.film(x, y, s).x);
        ASSERT_EQ(a.film(x, y, s).y, b.film(x, y, s).y);
      }
    }
  }
}

WriteSyntheticOptions small_blocks(bool compress) {
  WriteSyntheticOptions options;
  options.tile_size = 16;
  options.block_spp = 4;
  options.writer.compress = compress;
  options.writer.force = true;
  return options;
}

TEST(LoadRecording, GivesBackWhatWasWrittenInTilesAndBlocksOfAnySize) {
  const ScratchFolder folder;
  const RecordedSamples made = make_scene_s(37, 21, 11, 5);
  for (const bool compress : {false, true}) {
    const WriteSyntheticOptions options = small_blocks(compress);
    const auto written = write_synthetic("scene_s", 37, 21, 11, 5, folder / "s.spool", options);
    ASSERT_TRUE(written.has_value()) << written.error().message;
    const auto loaded = load_recording(folder / "s.spool");
    ASSERT_TRUE(loaded.has_value()) << loaded.error().message;
    expect_same_samples(**loaded, made);
    EXPECT_TRUE((*loaded)->exchangeable());
    EXPECT_FALSE((*loaded)->cost_per_sample().has_value());
    ASSERT_TRUE((*loaded)->reference().has_value());
    const Reference& reference = *(*loaded)->reference();
    for (std::size_t p = 0; p < reference.mean[0].size(); ++p) {
      EXPECT_EQ(reference.mean[1][p], static_cast<float>(made.reference()->mean[1][p]));
      EXPECT_EQ((*reference.variance_of_mean)[1][p], 0.0);
    }
  }
}

// Notes what it is shown: [c][y][x][s].
class Notes : public FirstPass {
 public:
  void begin(const LayerGrid& grid) override {
    grid_ = grid;
    values.assign(std::size_t{3} * grid.width * grid.height * grid.spp, -1.0f);
  }
  void see(const BlockRow& row) override {
    const BlockView& block = *row.block;
    for (int x = 0; x < block.pixels.width(); ++x) {
      for (int s = 0; s < block.samples; ++s)
        values[index(row.channel, block.pixels.x0 + x, row.y, block.first + s)] =
            row.values[x * block.samples + s];
    }
  }
  std::size_t index(int c, int x, int y, int s) const {
    const std::size_t pixel = (static_cast<std::size_t>(c) * grid_.height + y) * grid_.width + x;
    return pixel * grid_.spp + s;
  }
  std::vector<float> values;

 private:
  LayerGrid grid_;
};

TEST(LoadRecording, ShowsEverySampleToThePassThatGoesWithIt) {
  const ScratchFolder folder;
  for (const bool compress : {false, true}) {
    const WriteSyntheticOptions options = small_blocks(compress);
    ASSERT_TRUE(write_synthetic("scene_s", 37, 21, 11, 5, folder / "s.spool", options).has_value());
    Notes notes;
    const auto loaded = load_recording(folder / "s.spool", {}, {}, SampleFilm::kLoad, &notes);
    ASSERT_TRUE(loaded.has_value()) << loaded.error().message;
    expect_same_samples(**loaded, make_scene_s(37, 21, 11, 5));
    for (int y = 0; y < 21; ++y) {
      for (int x = 0; x < 37; ++x) {
        for (int s = 0; s < 11; ++s) {
          const Rgb value = (*loaded)->radiance(x, y, s);
          for (int c = 0; c < 3; ++c)
            ASSERT_EQ(notes.values[notes.index(c, x, y, s)], value[static_cast<std::size_t>(c)]);
        }
      }
    }
  }
}

TEST(LoadRecording, FindsADamagedBlockWithAPassAndWithout) {
  const ScratchFolder folder;
  WriteSyntheticOptions options;
  options.tile_size = 16;
  ASSERT_TRUE(write_synthetic("scene_s", 32, 32, 16, 5, folder / "d.spool", options).has_value());
  {
    std::fstream file(folder / "d.spool", std::ios::in | std::ios::out | std::ios::binary);
    file.seekg(0, std::ios::end);
    const auto middle = file.tellg() / 2;
    file.seekg(middle);
    const int byte = file.get();
    file.seekp(middle);
    file.put(static_cast<char>(byte ^ 1));
  }
  Notes notes;
  for (FirstPass* pass : {static_cast<FirstPass*>(nullptr), static_cast<FirstPass*>(&notes)}) {
    const auto loaded = load_recording(folder / "d.spool", {}, {}, SampleFilm::kLoad, pass);
    ASSERT_FALSE(loaded.has_value());
    EXPECT_EQ(loaded.error().code, ErrorCode::kDamage);
    EXPECT_NE(loaded.error().message.find("checksum"), std::string::npos) << loaded.error().message;
  }
}

TEST(LoadRecording, ReportsTheSameHoweverTheFileIsCut) {
  const ScratchFolder folder;
  WriteSyntheticOptions options;
  options.scene.odds = 0.005;
  std::vector<SanitiseReport> reports;
  for (const int tile : {64, 16}) {
    options.tile_size = tile;
    options.block_spp = tile == 64 ? 16 : 3;
    options.writer.force = true;
    ASSERT_TRUE(
        write_synthetic("not_finite", 40, 36, 16, 5, folder / "n.spool", options).has_value());
    const auto loaded = load_recording(folder / "n.spool");
    ASSERT_TRUE(loaded.has_value()) << loaded.error().message;
    reports.push_back((*loaded)->report());
  }
  EXPECT_EQ(reports[1].samples, reports[0].samples);
  EXPECT_EQ(reports[1].nonfinite, reports[0].nonfinite);
  EXPECT_GT(reports[0].nonfinite, 20u);
  EXPECT_EQ(reports[1].first_x, reports[0].first_x);
  EXPECT_EQ(reports[1].first_y, reports[0].first_y);
  EXPECT_EQ(reports[1].first_sample, reports[0].first_sample);
  EXPECT_EQ(reports[1].empty_pixels, reports[0].empty_pixels);
}

// Tiles and blocks come in another order than rows and samples.
TEST(SanitiseReport, NamesTheFirstInRowOrder) {
  SanitiseReport tile, other;
  tile.add_nonfinite(3, 0, 1);
  tile.add_nonfinite(2, 0, 4);
  tile.add_nonfinite(2, 1, 0);
  other.add_nonfinite(0, 1, 0);
  other.add(tile);
  EXPECT_EQ(other.nonfinite, 4u);
  EXPECT_EQ(other.first_x, 2);
  EXPECT_EQ(other.first_y, 0);
  EXPECT_EQ(other.first_sample, 4);
}

TEST(LoadRecording, AppliesTheRules) {
  const ScratchFolder folder;
  WriteSyntheticOptions options;
  options.scene.odds = 0.005;
  ASSERT_TRUE(
      write_synthetic("not_finite", 40, 40, 16, 5, folder / "n.spool", options).has_value());
  SanitiseRules rules;
  const auto loaded = load_recording(folder / "n.spool", rules);
  ASSERT_TRUE(loaded.has_value()) << loaded.error().message;
  EXPECT_GT((*loaded)->report().nonfinite, 0u);
  rules.nonfinite = NonFiniteRule::kError;
  const auto refused = load_recording(folder / "n.spool", rules);
  ASSERT_FALSE(refused.has_value());
  EXPECT_EQ(refused.error().code, ErrorCode::kData);
}

// An eighth of radiance and film positions of 40 x 36 pixels and 128 samples, as the environment
// says.
class LittleMemory {
 public:
  LittleMemory() { ::setenv("SPOOL_MEMORY", std::to_string(40 * 36 * 128 * 20 / 8).c_str(), 1); }
  ~LittleMemory() { ::unsetenv("SPOOL_MEMORY"); }
  LittleMemory(const LittleMemory&) = delete;
  LittleMemory& operator=(const LittleMemory&) = delete;

 private:
  const ThreadLimit two_threads_{2};
};

TEST(LoadRecording, ReadsBlockByBlockWhatIsLargerThanMemory) {
  const ScratchFolder folder;
  WriteSyntheticOptions options;
  options.tile_size = 16;
  options.block_spp = 8;
  options.writer.force = true;
  for (const bool compress : {false, true}) {
    options.writer.compress = compress;
    ASSERT_TRUE(
        write_synthetic("scene_s", 40, 36, 128, 5, folder / "s.spool", options).has_value());
    const auto in_place = load_recording(folder / "s.spool");
    ASSERT_TRUE(in_place.has_value()) << in_place.error().message;
    EXPECT_TRUE((*in_place)->blocks().in_place());
    const LittleMemory little;
    const auto in_blocks = load_recording(folder / "s.spool");
    ASSERT_TRUE(in_blocks.has_value()) << in_blocks.error().message;
    EXPECT_FALSE((*in_blocks)->blocks().in_place());
    expect_same_samples(**in_blocks, **in_place, 5);
    EXPECT_TRUE(still_intact(*in_blocks).has_value());
  }
}

TEST(LoadRecording, ABlockThatIsDamagedWhenItIsReadAgainIsSaid) {
  const ScratchFolder folder;
  WriteSyntheticOptions options;
  options.tile_size = 16;
  options.block_spp = 8;
  ASSERT_TRUE(write_synthetic("scene_s", 40, 36, 128, 5, folder / "s.spool", options).has_value());
  const LittleMemory little;
  const auto loaded = load_recording(folder / "s.spool");
  ASSERT_TRUE(loaded.has_value()) << loaded.error().message;
  std::fstream file(folder / "s.spool", std::ios::in | std::ios::out | std::ios::binary);
  const auto bytes = std::filesystem::file_size(folder / "s.spool");
  for (std::uintmax_t at = 4096; at + 4096 < bytes; at += 1024)
    file.seekp(static_cast<std::streamoff>(at)).put('?');
  file.close();
  for (int y = 0; y < 36; y += 4) {
    for (int x = 0; x < 40; x += 4)
      EXPECT_TRUE(is_ordinary((*loaded)->radiance(x, y, 127)));
  }
  ASSERT_FALSE(still_intact(*loaded).has_value());
  EXPECT_EQ(still_intact(*loaded).error().code, ErrorCode::kDamage);
}

TEST(LoadRecording, MissingFileIsAnIoError) {
  const ScratchFolder folder;
  const auto loaded = load_recording(folder / "absent.spool");
  ASSERT_FALSE(loaded.has_value());
  EXPECT_EQ(loaded.error().code, ErrorCode::kIo);
}

template <class T>
void write_block(format::SpoolWriter& writer, std::uint16_t group, std::uint32_t tile,
                 std::uint32_t begin, std::uint32_t count, const std::vector<T>& values) {
  const auto written =
      writer.write_block(group, tile, begin, count, std::as_bytes(std::span(values)));
  ASSERT_TRUE(written.has_value()) << written.error().message;
}

format::DumpHeader small_header(format::DataType type) {
  format::DumpHeader header;
  header.width = 10;
  header.height = 3;
  header.tile_size = 8;
  header.spp = 3;
  header.block_spp = 2;
  header.channels = format::radiance_channels(type);
  return header;
}

TEST(LoadRecording, WidensHalfFloatsAndReadsPassFilmAndCost) {
  const ScratchFolder folder;
  format::DumpHeader header = small_header(format::DataType::kFloat16);
  header.channels.push_back({"film.X", 1, format::DataType::kFloat32, 6, format::Scope::kPass});
  header.channels.push_back({"film.Y", 1, format::DataType::kFloat32, 6, format::Scope::kPass});
  auto writer = format::SpoolWriter::create(folder / "h.spool", header);
  ASSERT_TRUE(writer.has_value());
  constexpr std::uint16_t kHalfOfOne = 0x3C00, kHalfOfMinusTwo = 0xC000;
  for (const std::uint32_t tile : {0u, 1u}) {
    const std::size_t pixels = tile == 0 ? 24 : 6;
    write_block(*writer, 0, tile, 0, 2, std::vector<std::uint16_t>(3 * pixels * 2, kHalfOfOne));
    write_block(*writer, 0, tile, 2, 1, std::vector<std::uint16_t>(3 * pixels, kHalfOfMinusTwo));
  }
  write_block(*writer, 1, 0, 0, 2, std::vector<float>{0.25f, 0.5f, 0.75f, 0.0f});
  write_block(*writer, 1, 0, 2, 1, std::vector<float>{0.125f, 0.375f});
  ASSERT_TRUE(writer->write_meta(R"({"cost_per_sample": 2.5e-6})").has_value());
  ASSERT_TRUE(writer->finish().has_value());
  const auto loaded = load_recording(folder / "h.spool");
  ASSERT_TRUE(loaded.has_value()) << loaded.error().message;
  EXPECT_EQ((*loaded)->radiance(9, 2, 1), (Rgb{1.0f, 1.0f, 1.0f}));
  EXPECT_EQ((*loaded)->radiance(0, 0, 2), (Rgb{-2.0f, -2.0f, -2.0f}));
  EXPECT_EQ((*loaded)->film(4, 1, 1).x, 0.5f);
  EXPECT_EQ((*loaded)->film(9, 2, 1).y, 0.0f);
  EXPECT_EQ((*loaded)->film(9, 2, 2).y, 0.375f);
  EXPECT_EQ((*loaded)->cost_per_sample(), 2.5e-6);
  EXPECT_FALSE((*loaded)->exchangeable());
  EXPECT_FALSE((*loaded)->reference().has_value());
}

TEST(LoadRecording, MissingBlockIsRefusedWithItsTile) {
  const ScratchFolder folder;
  auto writer =
      format::SpoolWriter::create(folder / "m.spool", small_header(format::DataType::kFloat32));
  ASSERT_TRUE(writer.has_value());
  write_block(*writer, 0, 0, 0, 2, std::vector<float>(3 * 24 * 2, 1.0f));
  write_block(*writer, 0, 0, 2, 1, std::vector<float>(3 * 24, 1.0f));
  write_block(*writer, 0, 1, 0, 2, std::vector<float>(3 * 6 * 2, 1.0f));
  ASSERT_TRUE(writer->finish().has_value());
  const auto loaded = load_recording(folder / "m.spool");
  ASSERT_FALSE(loaded.has_value());
  EXPECT_EQ(loaded.error().code, ErrorCode::kDamage);
  EXPECT_NE(loaded.error().message.find("samples 2-2 of tile 1 (pixels 8,0 to 9,2)"),
            std::string::npos)
      << loaded.error().message;
}

// Of a recording of 30 pixels whose reference and its variance are these values everywhere.
Result<void> loaded_with(const ScratchFolder& folder, float reference, float variance,
                         const std::string& components = "RGB") {
  format::DumpHeader header = small_header(format::DataType::kFloat32);
  for (const std::uint16_t group : std::initializer_list<std::uint16_t>{1, 2})
    for (const char component : components)
      header.channels.push_back(
          {fmt::format("{}.{}", group == 1 ? "reference" : "reference_variance", component), group,
           format::DataType::kFloat32, 1, format::Scope::kPixel});
  SPOOL_ASSIGN(auto writer,
               format::SpoolWriter::create(folder / "r.spool", header, {.force = true}));
  for (const std::uint32_t tile : {0u, 1u}) {
    const std::size_t pixels = tile == 0 ? 24 : 6;
    write_block(writer, 0, tile, 0, 2, std::vector<float>(3 * pixels * 2, 1.0f));
    write_block(writer, 0, tile, 2, 1, std::vector<float>(3 * pixels, 1.0f));
    write_block(writer, 1, tile, 0, 1, std::vector<float>(3 * pixels, reference));
    write_block(writer, 2, tile, 0, 1, std::vector<float>(3 * pixels, variance));
  }
  SPOOL_TRY(writer.finish());
  return load_recording(folder / "r.spool").map([](const auto&) {});
}

TEST(LoadRecording, AReferenceInAnotherOrderOfColoursIsNotTakenForRgb) {
  const ScratchFolder folder;
  EXPECT_TRUE(loaded_with(folder, 1.0f, 0.5f).has_value());
  for (const char* components : {"BGR", "XYZ"}) {
    const Result<void> loaded = loaded_with(folder, 1.0f, 0.5f, components);
    ASSERT_FALSE(loaded.has_value()) << components;
    EXPECT_NE(loaded.error().message.find("layer reference is not R, G, B"), std::string::npos)
        << loaded.error().message;
  }
}

TEST(LoadRecording, AReferenceThatCannotJudgeIsRefusedWithItsPixel) {
  const ScratchFolder folder;
  constexpr float kNaN = std::numeric_limits<float>::quiet_NaN();
  EXPECT_TRUE(loaded_with(folder, 1.0f, 0.0f).has_value());
  for (const auto& [reference, variance, words] :
       {std::tuple(1.0f, -0.5f, "reference_variance: pixel 0,0: -0.5 is no variance"),
        {1.0f, kNaN, "reference_variance: pixel 0,0: nan is no variance"},
        {1.0f, std::numeric_limits<float>::infinity(), "inf is no variance"},
        {kNaN, 0.0f, "reference: no pixel is finite"}}) {
    const auto loaded = loaded_with(folder, reference, variance);
    ASSERT_FALSE(loaded.has_value()) << words;
    EXPECT_EQ(loaded.error().code, ErrorCode::kData);
    EXPECT_NE(loaded.error().message.find(words), std::string::npos) << loaded.error().message;
  }
}

}  // namespace
}  // namespace spool
