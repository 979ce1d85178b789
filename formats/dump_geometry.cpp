#include "formats/dump_geometry.h"

#include <algorithm>

#include "formats/checked_math.h"

namespace spool::format {

DumpGeometry::DumpGeometry(const DumpHeader& header)
    : width_(header.width),
      height_(header.height),
      tile_size_(header.tile_size),
      spp_(header.spp),
      block_spp_(header.block_spp),
      tiles_x_(static_cast<uint32_t>(divide_up(header.width, header.tile_size))),
      tiles_y_(static_cast<uint32_t>(divide_up(header.height, header.tile_size))),
      blocks_(static_cast<uint32_t>(divide_up(header.spp, header.block_spp))) {
  for (uint32_t c = 0; c < header.channels.size(); ++c) {
    const ChannelInfo& channel = header.channels[c];
    if (channel.group == groups_.size()) {
      GroupLayout group;
      group.first_channel = c;
      group.type = channel.type;
      group.scope = channel.scope;
      group.tiles = channel.scope == Scope::kPass ? 1 : tiles_x_ * tiles_y_;
      group.blocks = channel.scope == Scope::kPixel ? 1 : blocks_;
      group.first_slot = slot_count_;
      slot_count_ += group.tiles * group.blocks;
      groups_.push_back(group);
    }
    ++groups_.back().channel_count;
  }
}

PixelRect DumpGeometry::tile_rect(uint32_t tile) const {
  const uint32_t x0 = tile % tiles_x_ * tile_size_;
  const uint32_t y0 = tile / tiles_x_ * tile_size_;
  return {x0, y0, std::min(width_, x0 + tile_size_), std::min(height_, y0 + tile_size_)};
}

uint32_t DumpGeometry::block_begin(uint16_t group, uint32_t block) const {
  return groups_[group].scope == Scope::kPixel ? 0 : block * block_spp_;
}

uint32_t DumpGeometry::block_count(uint16_t group, uint32_t block) const {
  if (groups_[group].scope == Scope::kPixel) return 1;
  return std::min(block_spp_, spp_ - block * block_spp_);
}

uint64_t DumpGeometry::raw_bytes(uint16_t group, uint32_t tile, uint32_t block) const {
  const GroupLayout& layout = groups_[group];
  const PixelRect rect = layout.scope == Scope::kPass ? PixelRect{0, 0, 1, 1} : tile_rect(tile);
  // The limits of a valid header keep the product below 2^26.
  return *checked_product({layout.channel_count, rect.height(), rect.width(),
                           block_count(group, block), bytes_per_value(layout.type)});
}

std::optional<uint32_t> DumpGeometry::slot(uint16_t group, uint32_t tile, uint32_t block) const {
  if (group >= groups_.size()) return std::nullopt;
  const GroupLayout& layout = groups_[group];
  if (tile >= layout.tiles || block >= layout.blocks) return std::nullopt;
  return layout.first_slot + tile * layout.blocks + block;
}

std::optional<uint32_t> DumpGeometry::block_of(uint16_t group, uint32_t sample_begin) const {
  if (group >= groups_.size() || sample_begin % block_spp_ != 0) return std::nullopt;
  const uint32_t block = sample_begin / block_spp_;
  if (block >= groups_[group].blocks) return std::nullopt;
  return block;
}

}  // namespace spool::format
