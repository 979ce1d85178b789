#include "lib/sampling/multiscale/board_views.h"

#include <fmt/core.h>

namespace spool {
namespace {

// Calls visit(name, image) for every image of a board; image(board) gives the plane.
template <class T, class Visit>
void for_each_image(const MultiscaleOptions& options, std::string_view suffix, Visit&& visit) {
  const int levels = options.levels();
  const bool per_channel = options.channels == AnalysedChannels::kPerChannel;
  for (std::size_t i = 0; i < (per_channel ? 3u : 1u); ++i) {
    const std::string ending = per_channel ? fmt::format(".{}", "rgb"[i]) : std::string();
    const auto family = [&](std::string_view letter, int first, int last, auto&& image) {
      for (int k = first; k <= last; ++k) {
        const auto index = static_cast<std::size_t>(k - first);
        visit(fmt::format("{}{}.{}{}", letter, suffix, k, ending),
              [=](const AnalysedBoard<T>& board) -> const Image<T>& {
                return image(board.scalars[i])[index];
              });
      }
    };
    using Scalar = const ScalarAnalysis<T>&;
    const int pyramid_levels = board_pyramid(options).levels;
    family("f", 0, pyramid_levels, [](Scalar s) -> const auto& { return s.pyramid.coarse; });
    family("d", 0, pyramid_levels - 1, [](Scalar s) -> const auto& { return s.pyramid.detail; });
    family("V", 1, levels, [](Scalar s) -> const auto& { return s.variance; });
    family("A", 0, levels, [](Scalar s) -> const auto& { return s.attenuation; });
  }
  for (int k = 1; k <= levels; ++k) {
    visit(fmt::format("P{}.{}", suffix, k), [k](const AnalysedBoard<T>& board) -> const Image<T>& {
      return board.priority[static_cast<std::size_t>(k - 1)];
    });
  }
}

}  // namespace

BoardViews::BoardViews(const Views* wanted, std::string_view suffix, int width, int height,
                       const MultiscaleOptions& options)
    : options_(&options), suffix_(suffix) {
  if (wanted == nullptr) return;
  for_each_image<double>(options, suffix, [&](const std::string& name, auto&&) {
    if (wanted->wants(name)) views_.push_back({name, Plane(width, height)});
  });
}

template <class T>
void BoardViews::paste(const AnalysedBoard<T>& board) {
  if (views_.empty()) return;
  auto next = views_.begin();
  for_each_image<T>(*options_, suffix_, [&](const std::string& name, auto&& image) {
    if (next == views_.end() || next->name != name) return;
    paste_area(board, image(board), next->image);
    ++next;
  });
}

void BoardViews::hand_over(Views& views) const {
  for (const View& view : views_)
    views.add(view.name, view.image);
}

template <class T>
void add_board_views(const AnalysedBoard<T>& board, std::string_view suffix,
                     const MultiscaleOptions& options, Views* views) {
  if (views == nullptr) return;
  BoardViews all(views, suffix, board.window.width(), board.window.height(), options);
  all.paste(board);
  all.hand_over(*views);
}

LevelViews::LevelViews(const Views* wanted, int width, int height, int levels) {
  if (wanted == nullptr) return;
  bool any = false;
  for (int k = 0; k <= levels; ++k)
    any = any || wanted->wants(fmt::format("samples.{}", k));
  for (int k = 0; any && k <= levels; ++k)
    views_.push_back({fmt::format("samples.{}", k), Plane(width, height)});
}

void LevelViews::paste(const Board& board, const std::vector<CountImage>& level_of_samples) {
  for (std::size_t k = 0; k < views_.size(); ++k)
    paste_area(board, level_of_samples[k], views_[k].image);
}

void LevelViews::hand_over(const CountImage& explored, Views& views) {
  for (std::size_t i = 0; wanted() && i < explored.size(); ++i)
    views_[0].image[i] += explored[i];
  for (const View& view : views_)
    views.add(view.name, view.image);
}

#define SPOOL_INSTANTIATE_VIEWS(T)                                         \
  template void BoardViews::paste(const AnalysedBoard<T>&);                \
  template void add_board_views(const AnalysedBoard<T>&, std::string_view, \
                                const MultiscaleOptions&, Views*)
SPOOL_INSTANTIATE_VIEWS(double);
SPOOL_INSTANTIATE_VIEWS(float);
#undef SPOOL_INSTANTIATE_VIEWS

}  // namespace spool
