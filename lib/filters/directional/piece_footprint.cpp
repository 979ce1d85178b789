#include "lib/filters/directional/piece_footprint.h"

#include <cmath>
#include <limits>
#include <utility>
#include <vector>

#include "lib/core/extend.h"
#include "lib/filters/directional/base_image.h"
#include "lib/filters/directional/filter_offsets.h"

namespace spool {
namespace {

constexpr double kLeastWeight = 1e-300;  // as in anisotropic_filter.cpp

struct PieceWeight {
  int x = 0, y = 0;
  double weight = 0.0;
};

template <class T>
std::vector<double> widths_at(const FootprintInput<T>& input, int x, int y) {
  std::vector<double> widths;
  for (const Image<T>& delta : input.widths.delta)
    widths.push_back(static_cast<double>(delta(x, y)));
  return widths;
}

double piece_weight(int n, FilterWeighting weighting) {
  return weighting == FilterWeighting::kPerSample ? n : (n > 0 ? 1.0 : 0.0);
}

// Weights of eq 10 over the base image; they sum to 1.
template <class T>
std::vector<PieceWeight> weights_over_base(const FootprintInput<T>& input, int x, int y) {
  const int k = input.level(x, y);
  if (k == 0) return {{x, y, 1.0}};
  const FilterOptions& filter = input.options.filter;
  const std::vector<double> widths = widths_at(input, x, y);
  const Rectangle bounds = input.n.bounds();
  std::vector<PieceWeight> weights = {{x, y, piece_weight(input.n(x, y), filter.weighting)}};
  for (const FilterOffset& offset : filter_offsets(k, input.widths.beta, filter.window)) {
    const double delta = interpolated_width(offset.sector, widths, filter.eq12);      // (12)
    const double omega = std::exp(-0.5 * offset.squared_distance / (delta * delta));  // (11)
    for (const int side : {-1, 1}) {
      const int qx = x + side * offset.dx, qy = y + side * offset.dy;
      if (qx < bounds.x0 || qx >= bounds.x1 || qy < bounds.y0 || qy >= bounds.y1) continue;
      weights.push_back({qx, qy, omega * piece_weight(input.n(qx, qy), filter.weighting)});
    }
  }
  double total = 0.0;
  for (const PieceWeight& w : weights)
    total += w.weight;
  if (!(total >= kLeastWeight)) return {{x, y, 1.0}};
  for (PieceWeight& w : weights)
    w.weight /= total;
  return weights;
}

// Adds what a piece of the base image is made of, times `weight`.
template <class T>
void add_base_piece(const FootprintInput<T>& input, const PieceWeight& piece, Footprint& to) {
  const int q = input.pieces_per_side;
  const bool refused = !input.refused.empty() && input.refused(piece.x, piece.y) > 0.0;
  const Taps taps = base_taps(refused ? BaseImage::kNone : input.options.base);
  for (int j = taps.first; j <= taps.last(); ++j) {
    for (int i = taps.first; i <= taps.last(); ++i) {
      const int x = extend_symmetric(piece.x - i, input.n.width());
      const int y = extend_symmetric(piece.y - j, input.n.height());
      const double share = taps.values[static_cast<std::size_t>(i - taps.first)] *
                           taps.values[static_cast<std::size_t>(j - taps.first)];
      to.add(x / q, y / q, piece.weight * share, input.mean, input.n.index(x, y));
    }
  }
}

}  // namespace

template <class T>
void tell_footprints(const FootprintInput<T>& input, Footprints& footprints) {
  const int q = input.pieces_per_side;
  for (const auto& [pixel_x, pixel_y] : footprints.wanted()) {
    Footprint footprint{pixel_x, pixel_y, {}, {}};
    for (int i = 0; i < q * q; ++i) {
      const int x = pixel_x * q + i % q, y = pixel_y * q + i / q;
      for (PieceWeight piece : weights_over_base(input, x, y)) {
        if (piece.weight == 0.0) continue;
        piece.weight /= q * q;
        add_base_piece(input, piece, footprint);
      }
      const int k = input.level(x, y);
      FootprintShape shape{1 << k, input.widths.dominant(x, y), {}};
      const std::vector<double> widths = widths_at(input, x, y);
      for (std::size_t d = 0; k > 0 && d < widths.size(); ++d)
        shape.widths.emplace_back(input.widths.beta[d], widths[d]);
      if (k == 0) shape.direction = std::numeric_limits<double>::quiet_NaN();
      footprint.shapes.push_back(std::move(shape));
    }
    footprints.add(std::move(footprint));
  }
}

template void tell_footprints(const FootprintInput<float>&, Footprints&);
template void tell_footprints(const FootprintInput<double>&, Footprints&);

}  // namespace spool
