// Inside lib/image_io: how many chunks a part of an OpenEXR file has and how large they are, from
// its header alone. Rules: "OpenEXR File Layout" and "Technical Introduction to OpenEXR".
#pragma once

#include <cstdint>

namespace spool::exr {

struct PartShape {
  std::int64_t width = 0, height = 0;  // of the data window, pixels
  std::uint64_t pixel_bytes = 0;       // of all channels
  int compression = 0;                 // as Imf::Compression counts
  bool tiled = false;
  std::uint64_t tile_width = 0, tile_height = 0;
  int level_mode = 0;  // 0 one level, 1 mipmap, 2 ripmap
  bool round_up = false;
};

// Entries of the table of chunks. Sides from 1 to 2^20; tiles not empty where `tiled`.
std::uint64_t count_chunks(const PartShape& part);
// Bytes of the pixels of a whole chunk; a double, which does not overflow.
double chunk_bytes(const PartShape& part);

}  // namespace spool::exr
