#include "lib/filters/twin_guides/fit_table.h"

namespace spool {

FitTable::FitTable(const Lattice& lattice, const Rectangle& tile, int radius,
                   const ScaleInputs& inputs)
    : around_(grow(tile, radius, radius, radius, radius, lattice.bounds())),
      origin_x_(tile.x0),
      origin_y_(tile.y0),
      rows_(inputs.features.empty() ? kPosition
                                    : kPosition + static_cast<int>(kMostFeatureChannels)),
      pieces_(static_cast<std::size_t>(around_.area())),
      luminance_(static_cast<std::size_t>(around_.area())) {
  const float per_piece = 1.0f / static_cast<float>(lattice.step);
  std::size_t place = 0;
  for (int y = around_.y0; y < around_.y1; ++y) {
    for (int x = around_.x0; x < around_.x1; ++x, ++place) {
      const std::size_t piece = inputs.down.index(lattice.column(x), lattice.row(y));
      float* u = pieces_[place].lanes;
      u[0] = 1.0f;
      u[1] = down(y, per_piece * inputs.down[piece]);
      u[2] = right(x, per_piece * inputs.right[piece]);
      for (std::size_t c = 0; c < inputs.features.size(); ++c)
        u[kPosition + c] = inputs.features[c][piece];
      float* colour = u + rows_;
      for (std::size_t c = 0; c < 3; ++c) {
        colour[c] = inputs.colour[c][piece];
        colour[c + 3] = inputs.difference[c][piece];
      }
      luminance_[place] = static_cast<float>(luminance(colour[0], colour[1], colour[2]));
    }
  }
}

}  // namespace spool
