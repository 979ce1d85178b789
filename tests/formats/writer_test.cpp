// What a writer promises: nothing is overwritten, nothing incomplete bears the final name.
#include <gtest/gtest.h>

#include "formats/dump_check.h"
#include "formats/spool_reader.h"
#include "formats/spool_writer.h"
#include "tests/formats/made_dump.h"

namespace spool::format {
namespace {

MadeDump tiny() {
  MadeDump dump;
  dump.header = small_header(4, 3, 2, 1);
  return dump;
}

TEST(SpoolWriter, RefusesAnExistingTargetAndLeavesItAlone) {
  const ScratchFolder folder;
  const auto path = folder / "a.spool";
  write_bytes(path, Bytes(5, std::byte{7}));
  const auto made = make_dump(path, tiny());
  ASSERT_FALSE(made);
  EXPECT_EQ(made.error().code, ErrorCode::kUsage);
  EXPECT_EQ(read_bytes(path), Bytes(5, std::byte{7}));
  EXPECT_FALSE(std::filesystem::exists(folder / "a.spool.partial"));

  MadeDump forced = tiny();
  forced.options.force = true;
  ASSERT_TRUE(make_dump(path, forced));
  EXPECT_TRUE(check_dump(path)->complete);
}

TEST(SpoolWriter, TargetThatAppearsMeanwhileIsKept) {
  const ScratchFolder folder;
  const auto path = folder / "a.spool";
  auto writer = SpoolWriter::create(path, tiny().header, {});
  ASSERT_TRUE(writer);
  ASSERT_TRUE(write_blocks(*writer, tiny()));
  write_bytes(path, Bytes(5, std::byte{7}));
  const auto finished = writer->finish();
  ASSERT_FALSE(finished);
  EXPECT_EQ(finished.error().code, ErrorCode::kUsage);
  EXPECT_EQ(read_bytes(path), Bytes(5, std::byte{7}));
  // Nothing is lost either: the dump is whole under its partial name.
  EXPECT_TRUE(check_dump(folder / "a.spool.partial")->complete);
}

TEST(SpoolWriter, LinkToADumpIsNotFollowed) {
  const ScratchFolder folder;
  ASSERT_TRUE(make_dump(folder / "real.spool", tiny()));
  const Bytes before = read_bytes(folder / "real.spool");
  std::filesystem::create_symlink(folder / "real.spool", folder / "link.spool");
  EXPECT_EQ(make_dump(folder / "link.spool", tiny()).error().code, ErrorCode::kUsage);
  std::filesystem::create_symlink(folder / "nowhere", folder / "dangling.spool");
  EXPECT_EQ(make_dump(folder / "dangling.spool", tiny()).error().code, ErrorCode::kUsage);
  MadeDump forced = tiny();
  forced.options.force = true;
  forced.seed = 9;
  ASSERT_TRUE(make_dump(folder / "link.spool", forced));
  EXPECT_EQ(read_bytes(folder / "real.spool"), before);
}

TEST(SpoolWriter, LeavesARecoverablePartialFileWhenDropped) {
  const ScratchFolder folder;
  const auto path = folder / "a.spool";
  {
    auto writer = SpoolWriter::create(path, tiny().header, {});
    ASSERT_TRUE(writer);
    ASSERT_TRUE(write_blocks(*writer, tiny()));
  }
  EXPECT_FALSE(std::filesystem::exists(path));
  const auto report = check_dump(folder / "a.spool.partial");
  ASSERT_TRUE(report) << report.error().message;
  EXPECT_FALSE(report->opens);
  EXPECT_EQ(report->records, 4u);
  EXPECT_TRUE(report->missing.empty());
  // The stale file is not silently overwritten.
  EXPECT_EQ(SpoolWriter::create(path, tiny().header, {}).error().code, ErrorCode::kUsage);
  EXPECT_TRUE(SpoolWriter::create(path, tiny().header, {.force = true}));
}

TEST(SpoolWriter, TwoWritersDoNotShareAFile) {
  const ScratchFolder folder;
  auto first = SpoolWriter::create(folder / "a.spool", tiny().header, {});
  ASSERT_TRUE(first);
  const auto second = SpoolWriter::create(folder / "a.spool", tiny().header, {.force = true});
  ASSERT_FALSE(second);
  EXPECT_EQ(second.error().code, ErrorCode::kIo);
  EXPECT_EQ(SpoolWriter::create(folder / "a.spool", tiny().header, {}).error().code,
            ErrorCode::kIo);
  ASSERT_TRUE(write_blocks(*first, tiny()));
  ASSERT_TRUE(first->finish());
  EXPECT_TRUE(check_dump(folder / "a.spool")->complete);
}

TEST(SpoolWriter, RefusesCallsThatBreakTheLayout) {
  const ScratchFolder folder;
  auto writer = SpoolWriter::create(folder / "a.spool", tiny().header, {});
  ASSERT_TRUE(writer);
  const Bytes right(3 * 4 * 3 * 4);
  EXPECT_EQ(writer->write_block(0, 0, 0, 1, Bytes(right.size() - 1)).error().code,
            ErrorCode::kUsage);
  EXPECT_EQ(writer->write_block(1, 0, 0, 1, right).error().code, ErrorCode::kUsage);
  EXPECT_EQ(writer->write_block(0, 1, 0, 1, right).error().code, ErrorCode::kUsage);
  EXPECT_EQ(writer->write_block(0, 0, 2, 1, right).error().code, ErrorCode::kUsage);
  EXPECT_EQ(writer->write_block(0, 0, 0, 2, right).error().code, ErrorCode::kUsage);
  ASSERT_TRUE(writer->write_block(0, 0, 0, 1, right));
  EXPECT_EQ(writer->write_block(0, 0, 0, 1, right).error().code, ErrorCode::kUsage);
  // A refused call costs nothing: the dump goes on.
  ASSERT_TRUE(writer->write_block(0, 0, 1, 1, right));
  ASSERT_TRUE(writer->finish());
  EXPECT_EQ(writer->finish().error().code, ErrorCode::kUsage);
  EXPECT_EQ(writer->write_meta("{}").error().code, ErrorCode::kUsage);
  EXPECT_TRUE(check_dump(folder / "a.spool")->complete);
}

TEST(SpoolWriter, RefusesHeadersOutsideTheLimits) {
  const ScratchFolder folder;
  const auto refused = [&](auto change) {
    DumpHeader header = tiny().header;
    change(header);
    const auto writer = SpoolWriter::create(folder / "a.spool", header, {});
    return !writer && writer.error().code == ErrorCode::kUsage;
  };
  EXPECT_TRUE(refused([](DumpHeader& h) { h.width = 0; }));
  EXPECT_TRUE(refused([](DumpHeader& h) { h.width = 65537; }));
  EXPECT_TRUE(refused([](DumpHeader& h) { h.width = h.height = 65536; }));
  EXPECT_TRUE(refused([](DumpHeader& h) { h.tile_size = 4; }));
  EXPECT_TRUE(refused([](DumpHeader& h) { h.tile_size = 48; }));
  EXPECT_TRUE(refused([](DumpHeader& h) { h.tile_size = 512; }));
  EXPECT_TRUE(refused([](DumpHeader& h) { h.spp = 0; }));
  EXPECT_TRUE(refused([](DumpHeader& h) { h.block_spp = 1025; }));
  EXPECT_TRUE(refused([](DumpHeader& h) { h.channels.pop_back(); }));
  EXPECT_TRUE(refused([](DumpHeader& h) { h.channels[1].name = "radiance.R"; }));
  EXPECT_TRUE(refused([](DumpHeader& h) { h.channels[0].type = DataType::kFloat16; }));
  EXPECT_TRUE(refused([](DumpHeader& h) {
    h.width = h.height = 4096;
    h.tile_size = 256;
    h.spp = h.block_spp = 86;  // a block of 64.5 MiB
  }));
  EXPECT_TRUE(refused([](DumpHeader& h) {
    h.width = h.height = 8192;
    h.tile_size = 8;
    h.block_spp = 1;  // 2^20 blocks for one sample
  }));
  EXPECT_TRUE(refused([](DumpHeader& h) { add_group(h, {"Albedo.R"}, DataType::kFloat32); }));
  EXPECT_TRUE(refused([](DumpHeader& h) { add_group(h, {"albedo"}, DataType::kFloat32); }));
  EXPECT_TRUE(refused([](DumpHeader& h) { add_group(h, {"albedo.R.x"}, DataType::kFloat32); }));
  EXPECT_TRUE(refused([](DumpHeader& h) {
    add_group(h, {"a12345678901234567890123456789.RR"}, DataType::kFloat32);
  }));
  EXPECT_TRUE(refused([](DumpHeader& h) {
    add_group(h, {"albedo.R"}, DataType::kFloat32);
    add_group(h, {"albedo.G"}, DataType::kFloat32);  // one layer in two groups
  }));
  EXPECT_TRUE(refused([](DumpHeader& h) {
    add_group(h, {"albedo.R", "depth.Z", "albedo.G"}, DataType::kFloat32);
  }));
  EXPECT_TRUE(refused([](DumpHeader& h) {
    add_group(h, {"depth.Z"}, DataType::kFloat32);
    ++h.channels.back().group;
  }));
  EXPECT_FALSE(std::filesystem::exists(folder / "a.spool.partial"));
  EXPECT_FALSE(refused([](DumpHeader& h) { h.tile_size = 256; }));
}

TEST(SpoolWriter, AcceptsOneJsonObjectAsMeta) {
  const ScratchFolder folder;
  auto writer = SpoolWriter::create(folder / "a.spool", tiny().header, {});
  ASSERT_TRUE(writer);
  const auto nested = [](int depth) {
    return R"({"a":)" + std::string(static_cast<size_t>(depth - 1), '[') + "1" +
           std::string(static_cast<size_t>(depth - 1), ']') + "}";
  };
  for (const std::string& text : {std::string(R"({"a":1,"b":"\u00e4\ud83d\ude00"})"),
                                  std::string("{} \n"), nested(kMaxMetaDepth)}) {
    EXPECT_TRUE(writer->write_meta(text)) << text;
  }
  for (const std::string& text :
       {std::string(), std::string("{"), std::string("[1]"), std::string(" {}"),
        std::string("{} {}"), std::string("{\"a\":NaN}"), std::string("{\"a\":1e999}"),
        std::string("{\"a\":\"\xFF\"}"), std::string("\xEF\xBB\xBF{}"),
        std::string("{\"a\":\"\\ud800\"}"), std::string("{'a':1}"), std::string("{\"a\":1,}"),
        std::string("{\"a\":\"") + std::string(kMaxMetaBytes, 'x') + "\"}",
        nested(kMaxMetaDepth + 1), std::string("{}\0", 3)}) {
    const auto written = writer->write_meta(text);
    EXPECT_FALSE(written) << text.substr(0, 40);
    if (!written) {
      EXPECT_EQ(written.error().code, ErrorCode::kUsage);
    }
  }
  for (uint32_t i = 3; i < kMaxMetaRecords; ++i)
    EXPECT_TRUE(writer->write_meta("{}"));
  EXPECT_FALSE(writer->write_meta("{}"));
}

TEST(SpoolWriter, DrawsANewIdentityForEachDump) {
  const ScratchFolder folder;
  MadeDump dump = tiny();
  dump.options.uuid.reset();
  ASSERT_TRUE(make_dump(folder / "a.spool", dump));
  ASSERT_TRUE(make_dump(folder / "b.spool", dump));
  EXPECT_NE(SpoolReader::open(folder / "a.spool")->header().uuid,
            SpoolReader::open(folder / "b.spool")->header().uuid);
}

TEST(SpoolWriter, NamesTheSystemsRefusal) {
  const ScratchFolder folder;
  EXPECT_EQ(make_dump(folder / "none/a.spool", tiny()).error().code, ErrorCode::kIo);
  const std::string long_name(256, 'n');
  EXPECT_EQ(make_dump(folder / long_name.c_str(), tiny()).error().code, ErrorCode::kIo);
}

}  // namespace
}  // namespace spool::format
