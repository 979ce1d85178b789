// X5: the machine loses power. From a trace of what a writer asked of the system, states of the
// disk are made that may then be found: everything until the last fsync of a file, and of what came
// after any pages, in their new form, their old one, or as zeros [PillaiEtAl14].
#include <fcntl.h>

#include <gtest/gtest.h>

#include <map>

#include "formats/dump_check.h"
#include "formats/file_handle.h"
#include "formats/spool_reader.h"
#include "formats/spool_recovery.h"
#include "tests/formats/made_dump.h"
#include "tests/support/trust.h"

namespace spool::format {
namespace {

constexpr size_t kPage = 4096;

struct Event {
  enum Kind { kWrite, kTruncate, kSync, kRename, kSyncFolder, kAcknowledge } kind = kWrite;
  uint64_t offset = 0;  // kTruncate: the size; kAcknowledge: blocks written
  Bytes bytes = {};
};

std::vector<Event>& trace() {
  static std::vector<Event> events;
  return events;
}
std::map<int, bool>& folders() {  // descriptor -> is a folder
  static std::map<int, bool> open;
  return open;
}

FileCalls recording_calls() {
  FileCalls calls = posix_calls();
  calls.open = [](const char* path, int flags, mode_t mode) {
    const int fd = posix_calls().open(path, flags, mode);
    folders()[fd] = (flags & O_DIRECTORY) != 0;
    return fd;
  };
  calls.pwrite = [](int fd, const void* data, size_t bytes, off_t offset) {
    const auto* at = static_cast<const std::byte*>(data);
    trace().push_back({Event::kWrite, static_cast<uint64_t>(offset), Bytes(at, at + bytes)});
    return posix_calls().pwrite(fd, data, bytes, offset);
  };
  calls.ftruncate = [](int fd, off_t bytes) {
    trace().push_back({Event::kTruncate, static_cast<uint64_t>(bytes)});
    return posix_calls().ftruncate(fd, bytes);
  };
  calls.fsync = [](int fd) {
    trace().push_back({folders()[fd] ? Event::kSyncFolder : Event::kSync});
    return posix_calls().fsync(fd);
  };
  calls.rename = [](const char* from, const char* to, bool replace) {
    trace().push_back({Event::kRename});
    return posix_calls().rename(from, to, replace);
  };
  return calls;
}

// Blocks of several pages, and a sync every few of them.
MadeDump traced_dump() {
  MadeDump dump;
  dump.header = small_header(40, 24, 12, 4, 16);
  dump.meta = {R"({"seed":1})"};
  dump.options.sync_every_bytes = 20000;
  return dump;
}

std::vector<Event> record_trace(const std::filesystem::path& path, const MadeDump& dump) {
  trace().clear();
  static const FileCalls calls = recording_calls();
  replace_file_calls(calls);
  auto writer = SpoolWriter::create(path, dump.header, dump.options);
  EXPECT_TRUE(writer && writer->write_meta(dump.meta[0]));
  const DumpGeometry geometry(dump.header);
  uint64_t written = 0;
  for (uint32_t tile = 0; tile < geometry.groups()[0].tiles; ++tile)
    for (uint32_t block = 0; block < geometry.blocks(); ++block) {
      EXPECT_TRUE(writer->write_block(0, tile, geometry.block_begin(0, block),
                                      geometry.block_count(0, block),
                                      block_bytes(geometry, 0, tile, block, dump.seed, false)));
      trace().push_back({Event::kAcknowledge, ++written});
    }
  EXPECT_TRUE(writer->finish());
  replace_file_calls(posix_calls());
  return trace();
}

void apply(const Event& event, Bytes& file) {
  if (event.kind == Event::kTruncate) file.resize(event.offset);
  if (event.kind != Event::kWrite) return;
  if (file.size() < event.offset + event.bytes.size())
    file.resize(event.offset + event.bytes.size());
  std::copy(event.bytes.begin(), event.bytes.end(),
            file.begin() + static_cast<ptrdiff_t>(event.offset));
}

// What the disk may hold after the first `count` events.
struct State {
  Bytes synced;       // what the last fsync made sure of
  Bytes written;      // what a machine that goes on would see
  uint64_t safe = 0;  // blocks acknowledged before that fsync
  uint64_t written_blocks = 0;
  bool renamed = false, rename_is_safe = false;
};

State state_after(const std::vector<Event>& events, size_t count) {
  State state;
  for (size_t i = 0; i < count; ++i) {
    apply(events[i], state.written);
    switch (events[i].kind) {
      case Event::kSync:
        state.synced = state.written;
        state.safe = state.written_blocks;
        break;
      case Event::kAcknowledge:
        state.written_blocks = events[i].offset;
        break;
      case Event::kRename:
        state.renamed = true;
        break;
      case Event::kSyncFolder:
        state.rename_is_safe = true;
        break;
      default:
        break;
    }
  }
  return state;
}

// The file with random pages of the last epoch lost, zeroed or there.
Bytes disk_after(const State& state, uint64_t seed) {
  // The size is either one or anything a partial write-back left.
  const uint64_t small = std::min(state.synced.size(), state.written.size());
  const uint64_t large = std::max(state.synced.size(), state.written.size());
  const uint64_t kind = mix(seed) % 4;
  const uint64_t size = kind == 0   ? state.synced.size()
                        : kind == 1 ? state.written.size()
                                    : small + mix(seed + 1) % (large - small + 1);
  Bytes disk(size);
  for (uint64_t page = 0; page * kPage < size; ++page) {
    const uint64_t begin = page * kPage, end = std::min(size, begin + kPage);
    const auto same = [&] {
      for (uint64_t i = begin; i < end; ++i) {
        if (i >= state.synced.size() || i >= state.written.size() ||
            state.synced[i] != state.written[i])
          return false;
      }
      return true;
    };
    const uint64_t fate = same() ? 0 : mix(seed * 977 + page) % 4;
    for (uint64_t i = begin; i < end; ++i) {
      const bool was = i < state.synced.size(), is = i < state.written.size();
      // Old (zeros where the file was shorter), new, or new up to a torn sector.
      const uint64_t sector = mix(seed + page) % kPage / 512 * 512;
      if (fate == 1 || (fate == 2 && i - begin >= sector))
        disk[i] = was ? state.synced[i] : std::byte{0};
      else
        disk[i] = is ? state.written[i] : was ? state.synced[i] : std::byte{0};
    }
  }
  return disk;
}

void expect_survivors(const std::filesystem::path& path, const MadeDump& dump, uint64_t safe,
                      uint64_t seed) {
  const std::filesystem::path out = path.parent_path() / "recovered.spool";
  const auto report = recover_dump(path, out, true);
  if (!report) {
    ASSERT_EQ(safe, 0u) << seed << " " << report.error().message;
    return;
  }
  ASSERT_GE(report->kept_blocks, safe) << seed;
  const auto reader = SpoolReader::open(out);
  ASSERT_TRUE(reader);
  const DumpGeometry geometry(dump.header);
  uint64_t number = 0;
  for (uint32_t tile = 0; tile < geometry.groups()[0].tiles; ++tile)
    for (uint32_t block = 0; block < geometry.blocks(); ++block, ++number) {
      const bool there = reader->has_block(0, tile, block);
      if (number < safe) {
        ASSERT_TRUE(there) << seed;
      }
      if (there) {
        ASSERT_EQ(*reader->read_block(0, tile, block),
                  block_bytes(geometry, 0, tile, block, dump.seed, false));
      }
    }
}

TEST(PowerLoss, KeepsWhatWasSyncedAndExposesNoUnfinishedFile) {
  const ScratchFolder folder;
  const MadeDump dump = traced_dump();
  const auto events = record_trace(folder / "traced.spool", dump);
  size_t syncs = 0;
  for (const Event& event : events)
    syncs += event.kind == Event::kSync ? 1 : 0;
  ASSERT_GT(syncs, 3u);
  ASSERT_EQ(read_bytes(folder / "traced.spool"), state_after(events, events.size()).written);
  const Bytes finished = state_after(events, events.size()).written;
  const uint64_t states = test::trust_count(2000, 20000);
  uint64_t opened = 0, with_losses = 0;
  for (uint64_t seed = 0; seed < states; ++seed) {
    const State state = state_after(events, 1 + seed % events.size());
    const Bytes disk = disk_after(state, seed);
    const auto path = folder / "found.spool";
    write_bytes(path, disk);
    const auto report = check_dump(path);
    const bool whole = report && report->complete;
    opened += whole;
    with_losses += disk != state.written;
    // Under its own name a file is only ever found whole.
    if (state.renamed) {
      ASSERT_TRUE(whole) << seed;
    }
    // Whatever opens as complete holds every sample.
    if (whole) {
      ASSERT_EQ(disk, finished) << seed;
    }
    ASSERT_NO_FATAL_FAILURE(expect_survivors(path, dump, state.safe, seed));
  }
  EXPECT_GT(opened, 0u);
  EXPECT_GT(with_losses, states / 4);
}

}  // namespace
}  // namespace spool::format
