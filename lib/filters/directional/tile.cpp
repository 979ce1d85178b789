#include "lib/filters/directional/tile.h"

#include <algorithm>
#include <limits>

#include "lib/core/parallel.h"

namespace spool {
namespace {

std::vector<int> cut_axis(int begin, int end, int side, int least) {
  std::vector<int> cuts;
  for (int at = begin; at < end; at += side)
    cuts.push_back(at);
  if (cuts.size() > 1 && end - cuts.back() < least) cuts.pop_back();
  cuts.push_back(end);
  return cuts;
}

Tile crop(const Tile& whole, const Rectangle& box) {
  Tile part;
  part.x0 = whole.x0 + box.x0;
  part.y0 = whole.y0 + box.y0;
  part.pieces.n = cropped(whole.pieces.n, box);
  part.n = cropped(whole.n, box);
  for (std::size_t c = 0; c < 3; ++c) {
    part.pieces.mean[c] = cropped(whole.pieces.mean[c], box);
    part.pieces.variance[c] = cropped(whole.pieces.variance[c], box);
  }
  part.analysis.exposure = whole.analysis.exposure;
  part.analysis.mean = cropped(whole.analysis.mean, box);
  part.analysis.variance = cropped(whole.analysis.variance, box);
  part.minimum = cropped(whole.minimum, box);
  part.maximum = cropped(whole.maximum, box);
  for (const SizeChannel& c : whole.channels) {
    part.channels.push_back({cropped(c.mean, box), cropped(c.variance, box),
                             cropped(c.minimum, box), cropped(c.maximum, box)});
  }
  for (const Plane& a : whole.attenuation)
    part.cropped_attenuation.push_back(cropped(a, box));
  part.attenuation = part.cropped_attenuation;
  return part;
}

void join_views(const std::vector<Views>& of_tiles, const std::vector<Rectangle>& tiles,
                const Rectangle& bounds, Views& views) {
  std::vector<View> joined;
  for (std::size_t t = 0; t < tiles.size(); ++t) {
    for (const View& view : of_tiles[t].collected()) {
      auto at = std::find_if(joined.begin(), joined.end(),
                             [&](const View& v) { return v.name == view.name; });
      if (at == joined.end()) {
        joined.push_back({view.name, Plane(bounds.width(), bounds.height(),
                                           std::numeric_limits<double>::quiet_NaN())});
        at = joined.end() - 1;
      }
      paste(view.image, tiles[t], at->image);
    }
  }
  for (const View& view : joined)
    views.add(view.name, view.image);
}

}  // namespace

std::vector<Rectangle> cut_tiles(const Rectangle& bounds, int side, int least) {
  const std::vector<int> xs = cut_axis(bounds.x0, bounds.x1, side, least);
  const std::vector<int> ys = cut_axis(bounds.y0, bounds.y1, side, least);
  std::vector<Rectangle> tiles;
  for (std::size_t j = 0; j + 1 < ys.size(); ++j) {
    for (std::size_t i = 0; i + 1 < xs.size(); ++i)
      tiles.push_back({xs[i], ys[j], xs[i + 1], ys[j + 1]});
  }
  return tiles;
}

FilteredTile filter_tiles(const Tile& whole, int side, int least, const TileFilter& filter,
                          Views* views) {
  const Rectangle bounds = whole.pieces.n.bounds();
  const std::vector<Rectangle> tiles = cut_tiles(bounds, side, least);
  std::vector<FilteredTile> parts(tiles.size());
  std::vector<Views> tile_views(tiles.size(), views ? Views(views->wanted()) : Views());
  parallel_for(tiles.size(), [&](std::size_t t) {
    parts[t] = filter(crop(whole, tiles[t]), views ? &tile_views[t] : nullptr);
  });
  FilteredTile result;
  const int width = bounds.width(), height = bounds.height();
  result.pieces = {make_rgb(width, height), make_rgb(width, height)};
  result.level = CountImage(width, height);
  result.dominant = Plane(width, height);
  for (std::size_t t = 0; t < tiles.size(); ++t) {
    for (std::size_t c = 0; c < 3; ++c) {
      paste(parts[t].pieces.image[c], tiles[t], result.pieces.image[c]);
      paste(parts[t].pieces.variance[c], tiles[t], result.pieces.variance[c]);
    }
    paste(parts[t].level, tiles[t], result.level);
    paste(parts[t].dominant, tiles[t], result.dominant);
    result.guards += parts[t].guards;
  }
  if (views) join_views(tile_views, tiles, bounds, *views);
  return result;
}

}  // namespace spool
