// pack_passes on folders written here by hand, as dumps/passes.md describes them.
#include "formats/pass_folder.h"

#include <unistd.h>

#include <cmath>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <functional>
#include <limits>
#include <string>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <zlib.h>
#include <nlohmann/json.hpp>

#include "formats/spool_reader.h"
#include "formats/spool_recovery.h"
#include "tests/formats/faulty_calls.h"

namespace spool::format {
namespace {

namespace fs = std::filesystem;
using nlohmann::json;
using testing::HasSubstr;

constexpr uint32_t kWidth = 21;  // neither side a multiple of the tiles below
constexpr uint32_t kHeight = 11;
constexpr uint32_t kChannels = 7;

// A value that names its place; exact in f16.
float value_at(uint32_t pass, uint32_t c, uint32_t y, uint32_t x) {
  return static_cast<float>(static_cast<int>((pass * 31 + c * 17 + y * 7 + x * 3) % 1024)) / 16.0F;
}

json recording(const std::string& mode) {
  json channels = json::array();
  for (const char* name : {"radiance.R", "radiance.G", "radiance.B"}) {
    channels.push_back({{"name", name}, {"dtype", "f32"}});
  }
  for (const char* name : {"albedo.R", "albedo.G", "albedo.B"}) {
    channels.push_back({{"name", name}, {"dtype", "f16"}});
  }
  channels.push_back({{"name", "depth.Z"}, {"dtype", "f32"}});
  return {{"renderer", "Hand"},
          {"renderer_version", "1.0"},
          {"scene", {{"name", "test"}}},
          {"width", kWidth},
          {"height", kHeight},
          {"mode", mode},
          {"seed", 1},
          {"channels", channels},
          {"settings", {{"clamp", 0}}},
          {"layers", {{"depth", {{"note", "distance"}}}}}};
}

// Writes a folder that keeps all rules; the tests then break one.
class PassFolderTest : public testing::Test {
 protected:
  void SetUp() override {
    root_ =
        fs::temp_directory_path() / ("pass_folder_test_" + std::to_string(::getpid()) +
                                     testing::UnitTest::GetInstance()->current_test_info()->name());
    fs::remove_all(root_);
    fs::create_directories(root_);
  }
  void TearDown() override { fs::remove_all(root_); }

  static void write(const fs::path& path, const std::string& text,
                    std::ios::openmode mode = std::ios::trunc) {
    std::ofstream(path, std::ios::binary | mode) << text;
  }

  static void write_manifest(const fs::path& folder, const json& recording) {
    fs::create_directories(folder);
    const json manifest = {{"format", "spool-passes"}, {"version", 1}, {"recording", recording}};
    write(folder / "manifest.json", manifest.dump());
  }

  static void write_file(const fs::path& folder, json line, const std::vector<float>& values) {
    const std::string bytes(reinterpret_cast<const char*>(values.data()), 4 * values.size());
    write(folder / line["file"].get<std::string>(), bytes);
    line["crc32"] =
        ::crc32(0, reinterpret_cast<const Bytef*>(bytes.data()), static_cast<uInt>(bytes.size()));
    write(folder / "passes.jsonl", line.dump() + "\n", std::ios::app);
  }

  static std::vector<float> pass_values(uint32_t pass, uint32_t channels = kChannels) {
    std::vector<float> values;
    for (uint32_t c = 0; c < channels; ++c) {
      for (uint32_t y = 0; y < kHeight; ++y) {
        for (uint32_t x = 0; x < kWidth; ++x)
          values.push_back(value_at(pass, c, y, x));
      }
    }
    return values;
  }

  static json pass_line(uint32_t pass, const std::string& mode) {
    json line = {{"kind", "pass"},
                 {"index", pass},
                 {"file", fmt::format("pass_{:05}.f32", pass)},
                 {"seed", mode == "sequence" ? 7 : 1000 + pass},
                 {"sample_index", mode == "sequence" ? 64 + pass : 0},
                 {"samples", 1},
                 {"seconds", 0.5}};
    if (mode == "shift") line["film"] = {(pass + 0.5) / 64, 1 - (pass + 0.5) / 64};
    return line;
  }

  static json batch_line(uint32_t batch) {
    return {{"kind", "reference"},
            {"index", batch},
            {"file", fmt::format("reference_{:05}.f32", batch)},
            {"seed", 9000 + batch},
            {"sample_index", 4},
            {"samples", 4},
            {"seconds", 1.0}};
  }

  fs::path make_folder(const std::string& name, uint32_t first, uint32_t count, uint32_t batches,
                       const std::string& mode = "shift") {
    const fs::path folder = root_ / name;
    write_manifest(folder, recording(mode));
    for (uint32_t pass = first; pass < first + count; ++pass) {
      write_file(folder, pass_line(pass, mode), pass_values(pass));
    }
    for (uint32_t batch = 0; batch < batches; ++batch) {
      write_file(folder, batch_line(batch), pass_values(100 + batch * batch, 3));
    }
    return folder;
  }

  // Changes the lines of a folder's log.
  static void edit_log(const fs::path& folder, const std::function<void(json&)>& edit) {
    std::ifstream stream(folder / "passes.jsonl");
    std::string text;
    for (std::string line; std::getline(stream, line);) {
      json entry = json::parse(line);
      edit(entry);
      text += entry.dump() + "\n";
    }
    write(folder / "passes.jsonl", text);
  }

  void expect_refusal(const std::vector<fs::path>& folders, ErrorCode code,
                      const std::string& text) {
    const auto report = pack_passes(folders, root_ / "refused.spool");
    ASSERT_FALSE(report.has_value()) << text;
    EXPECT_EQ(static_cast<int>(report.error().code), static_cast<int>(code))
        << report.error().message;
    EXPECT_THAT(report.error().message, HasSubstr(text));
    EXPECT_EQ(report.error().message.find('\n'), std::string::npos);
    EXPECT_FALSE(fs::exists(root_ / "refused.spool"));
    EXPECT_FALSE(fs::exists(root_ / "refused.spool.partial"));
  }

  SpoolReader packed(const std::vector<fs::path>& folders, const PackOptions& options = {}) {
    const fs::path out = root_ / "packed.spool";
    const auto report = pack_passes(folders, out, options);
    EXPECT_TRUE(report.has_value()) << (report ? "" : report.error().message);
    auto reader = SpoolReader::open(out);
    EXPECT_TRUE(reader.has_value()) << (reader ? "" : reader.error().message);
    return std::move(*reader);
  }

  static void expect_samples(const SpoolReader& reader, const std::vector<uint32_t>& passes) {
    ASSERT_EQ(reader.header().spp, passes.size());
    uint32_t first = 0;
    for (const char* layer : {"radiance", "albedo", "depth"}) {
      const PixelRect all{0, 0, kWidth, kHeight};
      const auto count = static_cast<uint32_t>(passes.size());
      const auto values = reader.read_region(layer, all, 0, count);
      ASSERT_TRUE(values.has_value()) << values.error().message;
      const uint32_t channels = reader.find_layer(layer)->channel_count;
      size_t at = 0;
      for (uint32_t c = 0; c < channels; ++c) {
        for (uint32_t y = 0; y < kHeight; ++y) {
          for (uint32_t x = 0; x < kWidth; ++x) {
            for (uint32_t s = 0; s < count; ++s, ++at) {
              ASSERT_EQ((*values)[at], value_at(passes[s], first + c, y, x))
                  << layer << " c " << c << " y " << y << " x " << x << " s " << s;
            }
          }
        }
      }
      first += channels;
    }
  }

  fs::path root_;
};

PackOptions small_tiles() {
  PackOptions options;
  options.tile_size = 8;
  options.block_spp = 2;
  return options;
}

TEST_F(PassFolderTest, EverySampleStandsWhereItsPassSays) {
  const fs::path folder = make_folder("a", 0, 5, 0);
  for (const bool compress : {false, true}) {
    PackOptions options = small_tiles();
    options.compress = compress;
    options.force = true;
    const SpoolReader reader = packed({folder}, options);
    EXPECT_TRUE(reader.complete());
    EXPECT_EQ(reader.header().sample_order, SampleOrder::kExchangeable);
    EXPECT_EQ(reader.find_layer("albedo")->type, DataType::kFloat16);
    EXPECT_EQ(reader.find_layer("depth")->type, DataType::kFloat32);
    expect_samples(reader, {0, 1, 2, 3, 4});
  }
}

TEST_F(PassFolderTest, LittleMemoryChangesBlocksNotSamples) {
  const fs::path folder = make_folder("a", 0, 5, 2);
  PackOptions options;
  options.tile_size = 8;
  options.memory_bytes = 1;
  const SpoolReader reader = packed({folder}, options);
  EXPECT_EQ(reader.header().block_spp, 1U);
  expect_samples(reader, {0, 1, 2, 3, 4});
}

TEST_F(PassFolderTest, FilmPositionsAndSeedsArePassLayers) {
  const SpoolReader reader = packed({make_folder("a", 0, 5, 0)}, small_tiles());
  const auto film = reader.read_pass_layer("film");
  ASSERT_TRUE(film.has_value());
  for (uint32_t s = 0; s < 5; ++s) {
    EXPECT_EQ((*film)[s], (static_cast<float>(s) + 0.5F) / 64);
    EXPECT_EQ((*film)[5 + s], 1 - (static_cast<float>(s) + 0.5F) / 64);
  }
  const auto info = reader.find_layer("seed");
  ASSERT_TRUE(info.has_value());
  const auto block = reader.read_block(info->group, 0, 1);
  ASSERT_TRUE(block.has_value());
  uint32_t seeds[2];
  ASSERT_EQ(block->size(), sizeof(seeds));
  std::memcpy(seeds, block->data(), sizeof(seeds));
  EXPECT_EQ(seeds[0], 1002U);
  EXPECT_EQ(seeds[1], 1003U);
}

TEST_F(PassFolderTest, ReferenceIsTheMeanOfTheBatchesWithTheVarianceOfThatMean) {
  constexpr uint32_t kBatches = 7;
  const SpoolReader reader = packed({make_folder("a", 0, 1, kBatches)}, small_tiles());
  const auto mean = reader.read_pixel_layer("reference");
  const auto variance = reader.read_pixel_layer("reference_variance");
  ASSERT_TRUE(mean.has_value() && variance.has_value());
  size_t at = 0;
  for (uint32_t c = 0; c < 3; ++c) {
    for (uint32_t y = 0; y < kHeight; ++y) {
      for (uint32_t x = 0; x < kWidth; ++x, ++at) {
        double sum = 0.0;
        double squares = 0.0;
        for (uint32_t b = 0; b < kBatches; ++b)
          sum += value_at(100 + b * b, c, y, x);
        for (uint32_t b = 0; b < kBatches; ++b) {
          squares += std::pow(value_at(100 + b * b, c, y, x) - sum / kBatches, 2);
        }
        EXPECT_FLOAT_EQ((*mean)[at], static_cast<float>(sum / kBatches));
        EXPECT_FLOAT_EQ((*variance)[at], static_cast<float>(squares / (kBatches - 1) / kBatches));
      }
    }
  }
}

TEST_F(PassFolderTest, OneBatchKnowsNoVariance) {
  const SpoolReader reader = packed({make_folder("a", 0, 1, 1)});
  EXPECT_TRUE(reader.find_layer("reference").has_value());
  EXPECT_FALSE(reader.find_layer("reference_variance").has_value());
}

TEST_F(PassFolderTest, MetaSaysHowTheSamplesWereMade) {
  const SpoolReader reader = packed({make_folder("a", 0, 3, 2)});
  ASSERT_EQ(reader.meta().size(), 1U);
  const json meta = json::parse(reader.meta().front());
  EXPECT_EQ(meta["renderer"], "Hand");
  EXPECT_EQ(meta["version"], "1.0");
  EXPECT_EQ(meta["mode"], "shift");
  EXPECT_EQ(meta["settings"]["clamp"], 0);
  EXPECT_EQ(meta["seeds"], json({1000, 1001, 1002}));
  EXPECT_DOUBLE_EQ(meta["cost_per_sample"], 0.5 / (kWidth * kHeight));
  EXPECT_EQ(meta["cost_note"].get<std::string>().substr(0, 4), "wall");
  EXPECT_EQ(meta["reference"]["samples"], 8);
  EXPECT_EQ(meta["reference"]["batches"], 2);
  EXPECT_EQ(meta["reference"]["stratified"], true);
  EXPECT_EQ(meta["channels"]["depth"]["note"], "distance");
}

TEST_F(PassFolderTest, CostIsTheMedianOfCpuTimeWhereAllPassesHaveIt) {
  const fs::path a = make_folder("a", 0, 3, 2);
  edit_log(a, [](json& line) {
    if (line["kind"] == "pass") line["cpu_seconds"] = 2.0 + line["index"].get<double>();
  });
  const json meta = json::parse(packed({a}).meta().front());
  EXPECT_DOUBLE_EQ(meta["cost_per_sample"], 3.0 / (kWidth * kHeight));
  EXPECT_EQ(meta["cost_note"].get<std::string>().substr(0, 3), "CPU");
}

TEST_F(PassFolderTest, ASequenceKeepsTheOrderOfTheRenderer) {
  const SpoolReader reader = packed({make_folder("a", 0, 4, 1, "sequence")});
  EXPECT_EQ(reader.header().sample_order, SampleOrder::kRenderer);
  EXPECT_FALSE(reader.find_layer("film").has_value());
  expect_samples(reader, {0, 1, 2, 3});
}

TEST_F(PassFolderTest, FoldersWithDisjointPassesAreJoinedInTheOrderGiven) {
  const fs::path a = make_folder("a", 0, 2, 0);
  const fs::path b = make_folder("b", 2, 3, 2);
  const SpoolReader reader = packed({b, a}, small_tiles());
  expect_samples(reader, {2, 3, 4, 0, 1});
  EXPECT_TRUE(reader.find_layer("reference").has_value());
}

TEST_F(PassFolderTest, AnotherSeedOfTheRecordingMayBeJoined) {
  const fs::path a = make_folder("a", 0, 2, 0);
  const fs::path b = make_folder("b", 2, 2, 0);
  json other = recording("shift");
  other["seed"] = 2;
  write_manifest(b, other);
  const SpoolReader reader = packed({a, b});
  EXPECT_EQ(json::parse(reader.meta().front())["recording_seeds"], json({1, 2}));
}

TEST_F(PassFolderTest, OtherSettingsAreNotJoined) {
  const fs::path a = make_folder("a", 0, 2, 0);
  const fs::path b = make_folder("b", 2, 2, 0);
  json other = recording("shift");
  other["settings"]["clamp"] = 10;
  write_manifest(b, other);
  expect_refusal({a, b}, ErrorCode::kData, "settings.clamp: 0 there, 10 here");
}

TEST_F(PassFolderTest, OverlappingPassesAreRefused) {
  const fs::path a = make_folder("a", 0, 3, 0);
  const fs::path b = make_folder("b", 2, 2, 0);
  expect_refusal({a, b}, ErrorCode::kData, "has the seed 1002");
  expect_refusal({a, a}, ErrorCode::kData, "has the seed 1000");
}

TEST_F(PassFolderTest, AReferenceFromASeedOfThePoolIsRefused) {
  const fs::path a = make_folder("a", 0, 3, 2);
  edit_log(a, [](json& line) {
    if (line["kind"] == "reference" && line["index"] == 1) line["seed"] = 1001;
  });
  expect_refusal({a}, ErrorCode::kData, "has the seed 1001");
}

TEST_F(PassFolderTest, ASequenceWithAGapIsRefused) {
  const fs::path a = root_ / "a";
  write_manifest(a, recording("sequence"));
  for (const uint32_t pass : {0U, 1U, 3U}) {
    write_file(a, pass_line(pass, "sequence"), pass_values(pass));
  }
  expect_refusal({a}, ErrorCode::kData, "sample 2 of the sequence is missing");
}

TEST_F(PassFolderTest, ADamagedPassIsNamed) {
  const fs::path a = make_folder("a", 0, 3, 0);
  std::fstream file(a / "pass_00001.f32", std::ios::in | std::ios::out | std::ios::binary);
  file.seekp(100);
  file.put('\x55');
  file.close();
  expect_refusal({a}, ErrorCode::kDamage, "pass_00001.f32: damaged");
}

TEST_F(PassFolderTest, ARepeatedImageUnderAnotherSeedIsRefused) {
  const fs::path a = make_folder("a", 0, 5, 0);
  write_file(a, pass_line(4, "shift"), pass_values(1));  // the seed did not reach the renderer
  expect_refusal({a}, ErrorCode::kData, "image 4 is image 1 again, 1 of 5 are repeated");
  const fs::path b = make_folder("b", 0, 5, 0, "sequence");
  write_file(b, pass_line(4, "sequence"), pass_values(1));
  const auto report = pack_passes({b}, root_ / "b.spool");
  ASSERT_TRUE(report.has_value()) << report.error().message;
  EXPECT_THAT(report->remark, HasSubstr("image 4 is image 1 again"));
}

TEST_F(PassFolderTest, AMissingPassIsNamed) {
  const fs::path a = make_folder("a", 0, 3, 1);
  fs::remove(a / "reference_00000.f32");
  expect_refusal({a}, ErrorCode::kDamage, "reference_00000.f32: No such file");
  fs::remove(a / "pass_00002.f32");
  expect_refusal({a}, ErrorCode::kDamage, "pass_00002.f32: No such file");
}

TEST_F(PassFolderTest, APassOfAnotherSizeIsNamed) {
  const fs::path a = make_folder("a", 0, 3, 0);
  fs::resize_file(a / "pass_00000.f32", 4 * kWidth * kHeight * kChannels - 4);
  expect_refusal({a}, ErrorCode::kDamage, "6464 bytes instead of 6468 (7 planes of 21x11)");
}

TEST_F(PassFolderTest, ATornLastLineIsNoPass) {
  const fs::path a = make_folder("a", 0, 3, 0);
  fs::resize_file(a / "passes.jsonl", fs::file_size(a / "passes.jsonl") - 5);
  expect_samples(packed({a}), {0, 1});
}

TEST_F(PassFolderTest, ALaterLineReplacesAnEarlierOne) {
  const fs::path a = make_folder("a", 0, 2, 0);
  write_file(a, pass_line(0, "shift"), pass_values(9));
  expect_samples(packed({a}), {9, 1});
}

TEST_F(PassFolderTest, AFeatureThatF16CannotHoldIsRefusedNotClamped) {
  const fs::path a = root_ / "a";
  write_manifest(a, recording("shift"));
  std::vector<float> values = pass_values(0);
  values[(4 * kHeight + 2) * kWidth + 20] = 70000.0F;
  values[5] = 1e30F;                                    // radiance is f32
  values[6] = std::numeric_limits<float>::quiet_NaN();  // the loader's business
  write_file(a, pass_line(0, "shift"), values);
  expect_refusal({a}, ErrorCode::kData, "albedo.G is 70000 (pixel 20, 2)");
  PackOptions options;
  options.features_f32 = true;
  const SpoolReader reader = packed({a}, options);
  const auto albedo = reader.read_region("albedo", {20, 2, 21, 3}, 0, 1);
  ASSERT_TRUE(albedo.has_value());
  EXPECT_EQ((*albedo)[1], 70000.0F);
  const auto radiance = reader.read_region("radiance", {5, 0, 7, 1}, 0, 1);
  ASSERT_TRUE(radiance.has_value());
  EXPECT_EQ((*radiance)[0], 1e30F);
  EXPECT_TRUE(std::isnan((*radiance)[1]));
}

size_t passes_in(const fs::path& folder) {
  size_t count = 0;
  for (const fs::directory_entry& entry : fs::directory_iterator(folder))
    count += entry.path().extension() == ".f32";
  return count;
}

TEST_F(PassFolderTest, NoPassGoesBeforeAllOfThemAreFoundGood) {
  PackOptions options = small_tiles();
  options.remove_passes = true;
  const fs::path large = make_folder("large", 0, 5, 2);
  std::vector<float> values = pass_values(4);  // in the last block, when others would be gone
  values[(4 * kHeight + 2) * kWidth + 20] = 70000.0F;
  write_file(large, pass_line(4, "shift"), values);
  const fs::path repeated = make_folder("repeated", 0, 5, 2);
  write_file(repeated, pass_line(4, "shift"), pass_values(1));
  for (const fs::path& folder : {large, repeated}) {
    const auto report = pack_passes({folder}, root_ / "a.spool", options);
    ASSERT_FALSE(report.has_value());
    EXPECT_EQ(report.error().code, ErrorCode::kData) << report.error().message;
    EXPECT_EQ(passes_in(folder), 7U);
    EXPECT_FALSE(fs::exists(root_ / "a.spool.partial"));
  }
}

// Whatever write fails: each pass is in its folder, or in the unfinished file.
TEST_F(PassFolderTest, NoPassIsLostOnAFullDisk) {
  PackOptions options = small_tiles();
  options.remove_passes = true;
  size_t kept = 0;
  for (uint64_t bytes = 4096;; bytes += 1500) {
    const fs::path folder = make_folder(fmt::format("a{}", bytes), 0, 6, 2);
    const fs::path out = root_ / fmt::format("{}.spool", bytes);
    FaultPlan plan;
    plan.disk_bytes = bytes;
    Result<PackReport> report;
    {
      const FaultyCalls faulty(plan);
      report = pack_passes({folder}, out, options);
    }
    if (report) break;
    EXPECT_EQ(report.error().code, ErrorCode::kIo) << report.error().message;
    EXPECT_FALSE(fs::exists(out));
    const fs::path partial = out.string() + ".partial";
    const size_t there = passes_in(folder);
    if (there == 8) {
      EXPECT_FALSE(fs::exists(partial)) << bytes;  // the passes alone hold everything
      continue;
    }
    ++kept;
    EXPECT_THAT(report.error().message, HasSubstr(partial.string() + " keeps the passes"));
    const auto recovered = recover_dump(partial, root_ / "recovered.spool", true);
    ASSERT_TRUE(recovered.has_value()) << recovered.error().message;
    auto reader = SpoolReader::open(root_ / "recovered.spool");
    ASSERT_TRUE(reader.has_value()) << reader.error().message;
    EXPECT_TRUE(reader->find_layer("reference").has_value());
    const auto gone = static_cast<uint32_t>(6 - there);
    const auto radiance = reader->read_region("radiance", {5, 3, 6, 4}, 0, gone);
    ASSERT_TRUE(radiance.has_value()) << radiance.error().message;
    for (uint32_t s = 0; s < gone; ++s)
      EXPECT_EQ((*radiance)[s], value_at(s, 0, 3, 5));
  }
  EXPECT_GE(kept, 3U);
}

TEST_F(PassFolderTest, WhatIsNoPassFolderIsRefusedInOneLine) {
  expect_refusal({}, ErrorCode::kUsage, "no folder");
  expect_refusal({root_ / "nowhere"}, ErrorCode::kIo, "manifest.json: No such file");
  const fs::path a = root_ / "a";
  write_manifest(a, recording("shift"));
  expect_refusal({a}, ErrorCode::kIo, "passes.jsonl: No such file");
  write(a / "passes.jsonl", "");
  expect_refusal({a}, ErrorCode::kData, "no finished pass");
  for (const char* text :
       {"", "[]", "{\"format\": 3}", "{\"format\": \"spool-passes\"", "\xff\xfe"}) {
    write(a / "manifest.json", text);
    expect_refusal({a}, ErrorCode::kData, "not a manifest");
  }
}

TEST_F(PassFolderTest, BadKeysOfTheRecordingAreNamed) {
  const fs::path a = make_folder("a", 0, 1, 0);
  const std::vector<std::tuple<std::string, json, std::string>> cases = {
      {"width", 0, "width and height"},
      {"width", -4, "width and height"},
      {"height", 65537, "width and height"},
      {"height", 1.5, "width and height"},
      {"mode", "naive", "mode must be"},
      {"channels", json::array(), "channels must be"},
      {"channels", "radiance.R", "channels must be"},
      {"layers", json::array(), "layers must be"},
      {"layers", {{"film", 5}}, "layers must be"}};
  for (const auto& [key, value, message] : cases) {
    json changed = recording("shift");
    changed[key] = value;
    write_manifest(a, changed);
    expect_refusal({a}, ErrorCode::kData, message);
  }
}

TEST_F(PassFolderTest, AReferenceIsNoChannelOfAPass) {
  const fs::path a = make_folder("a", 0, 1, 0);
  json changed = recording("shift");
  for (const char* name : {"reference.R", "reference.G", "reference.B"})
    changed["channels"].push_back({{"name", name}, {"dtype", "f32"}});
  write_manifest(a, changed);
  expect_refusal({a}, ErrorCode::kData, "channel reference.R");
}

TEST_F(PassFolderTest, BadLinesAreNamedByNumber) {
  const std::vector<std::pair<std::string, json>> cases = {
      {"kind", "picture"},      {"index", -1},         {"file", "../secret.f32"}, {"file", ""},
      {"file", ".."},           {"crc32", 4294967296}, {"seed", "one"},           {"samples", 0},
      {"samples", 2},           {"seconds", -1.0},     {"film", {0.5, 1.0}},      {"film", {0.5}},
      {"sample_index", nullptr}};
  for (size_t i = 0; i < cases.size(); ++i) {
    const fs::path a = make_folder(fmt::format("a{}", i), 0, 3, 0);
    edit_log(a, [&](json& line) {
      if (line["index"] == 1) line[cases[i].first] = cases[i].second;
    });
    expect_refusal({a}, ErrorCode::kData, "line 2 is no entry");
  }
}

TEST_F(PassFolderTest, AnExistingDumpIsKeptUnlessForced) {
  const fs::path a = make_folder("a", 0, 2, 0);
  const fs::path out = root_ / "kept.spool";
  write(out, "precious");
  EXPECT_FALSE(pack_passes({a}, out).has_value());
  EXPECT_EQ(fs::file_size(out), 8U);
  PackOptions options;
  options.force = true;
  const auto report = pack_passes({a}, out, options);
  ASSERT_TRUE(report.has_value()) << report.error().message;
  EXPECT_EQ(report->spp, 2U);
  EXPECT_EQ(report->bytes, fs::file_size(out));
  EXPECT_THAT(report->layers, testing::ElementsAre("radiance", "albedo", "depth", "film", "seed"));
}

}  // namespace
}  // namespace spool::format
