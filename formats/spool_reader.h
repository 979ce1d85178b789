// Reads complete .spool files: strict at opening, checked at every access.
//
// open() follows formats/spool.md 7: every header, the index and the footer are verified, and no
// memory is taken on the file's word. A file NAME.partial is incomplete, whatever it holds. All
// other functions are const and may be called from any number of threads. Reads are positional;
// map_block() is the one way to a mapping.
//
// Errors: kIo missing or unreadable, kData not a .spool file, unsupported, or asked for data that
// was not recorded, kDamage damaged or incomplete (remedy: `spool recover`), kUsage out of range.
#pragma once

#include <cstddef>
#include <filesystem>
#include <functional>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "formats/dump_header.h"
#include "lib/core/error.h"

namespace spool::format {

class SpoolReader {
 public:
  static Result<SpoolReader> open(const std::filesystem::path& path);

  SpoolReader(SpoolReader&&) noexcept;
  SpoolReader& operator=(SpoolReader&&) noexcept;
  ~SpoolReader();

  const DumpHeader& header() const;
  const std::vector<std::string>& meta() const;  // JSON texts in file order
  const std::filesystem::path& path() const;
  uint64_t file_bytes() const;

  uint32_t tiles_x() const;
  uint32_t tiles_y() const;
  uint32_t tiles() const { return tiles_x() * tiles_y(); }
  uint32_t blocks() const;  // blocks per pixel of a sample group
  uint32_t group_count() const;
  PixelRect tile_rect(uint32_t tile) const;
  uint32_t block_begin(uint32_t block) const;  // first sample of a block
  uint32_t block_count(uint32_t block) const;  // samples of a block

  bool complete() const;  // every block of every group is present
  // For groups of scope pixel only block 0, of scope pass only tile 0 exists.
  bool has_block(uint16_t group, uint32_t tile, uint32_t block) const;
  bool is_raw(uint16_t group, uint32_t tile, uint32_t block) const;

  uint64_t raw_bytes(uint16_t group, uint32_t tile, uint32_t block) const;  // decoded

  // The stored bytes in place, dtype[channel][y][x][sample]; raw blocks only. Verified once per
  // process before they are handed out. Valid while the reader lives; cutting the file meanwhile
  // raises SIGBUS (POSIX), or with survive_lost_pages() turns what was cut into zeros: the code
  // that reads a mapped block asks intact() when he has read it.
  Result<std::span<const std::byte>> map_block(uint16_t group, uint32_t tile, uint32_t block) const;

  // The same, verified anew in pieces of `piece` bytes, > 0, that `look` gets in their order (the
  // last one may be shorter) while the processor's cache holds them. With kCopied they are read
  // into memory of the reader, and no page of the mapping is touched.
  enum class Pieces { kMapped, kCopied };
  using PieceLook = std::function<void(std::span<const std::byte> piece, std::size_t offset)>;
  Result<std::span<const std::byte>> map_block(uint16_t group, uint32_t tile, uint32_t block,
                                               std::size_t piece, Pieces pieces,
                                               const PieceLook& look) const;

  // kDamage when pages of mapped blocks were lost after they had been verified.
  Result<void> intact() const;

  // The decoded bytes, dtype[channel][y][x][sample]; verified each time.
  Result<std::vector<std::byte>> read_block(uint16_t group, uint32_t tile, uint32_t block) const;

  // The same of a raw block, into `bytes`, which are as many as the block has: memory that is
  // nowhere set before it is read.
  Result<void> read_raw_block(uint16_t group, uint32_t tile, uint32_t block,
                              std::span<std::byte> bytes) const;

  std::vector<LayerInfo> layers() const;
  std::optional<LayerInfo> find_layer(std::string_view layer) const;

  // float[c][y][x][s] of a layer of scope sample; f16 is widened. Touches only the blocks needed,
  // so the first k samples cost only their blocks. Layers of u32 are refused: use read_block.
  Result<std::vector<float>> read_region(std::string_view layer, PixelRect rect,
                                         uint32_t sample_begin, uint32_t sample_count) const;
  // float[c][y][x] of the whole image; scope pixel.
  Result<std::vector<float>> read_pixel_layer(std::string_view layer) const;
  // float[c][s]; scope pass.
  Result<std::vector<float>> read_pass_layer(std::string_view layer) const;

  uint64_t bytes_read()
      const;  // bytes taken from the file so far, opening and mapped blocks included

 private:
  struct State;
  explicit SpoolReader(std::unique_ptr<State> state);
  std::unique_ptr<State> state_;
};

}  // namespace spool::format
