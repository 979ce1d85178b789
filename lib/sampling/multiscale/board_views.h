// Intermediate images of the sampler, gathered from boards into images of the whole grid.
//
//   f.0 .. f.K, d.0 .., V.1 .., A.0 .., P.1 ..   at the end of the run
//   f_initial.0 .. and so on                      after the initial samples
//   samples.0 .. samples.K                        samples taken by pops of each level; 0: uniform
// With several analysed scalars, all but P and samples end in .r, .g or .b.
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "lib/core/view.h"
#include "lib/sampling/multiscale/board.h"

namespace spool {

// Copies the area of a board, an image of which is `from`, to where it lies in the grid.
template <class T>
void paste_area(const Board& board, const Image<T>& from, Plane& to) {
  for (int y = board.area.y0; y < board.area.y1; ++y) {
    for (int x = board.area.x0; x < board.area.x1; ++x)
      to(x + board.window.x0, y + board.window.y0) = static_cast<double>(from(x, y));
  }
}

// The views of one moment, for boards that cover the grid. Empty of images when none is asked for.
class BoardViews {
 public:
  // `suffix`: "" or "_initial". `wanted` may be null; `options` must outlive this.
  BoardViews(const Views* wanted, std::string_view suffix, int width, int height,
             const MultiscaleOptions& options);

  // Copies the area of a board. Several threads may paste boards with disjoint areas.
  template <class T>
  void paste(const AnalysedBoard<T>& board);
  void hand_over(Views& views) const;

 private:
  const MultiscaleOptions* options_;
  std::string suffix_;
  std::vector<View> views_;
};

// Hands the views of a board of the whole grid over at once; `views` may be null.
template <class T>
void add_board_views(const AnalysedBoard<T>& board, std::string_view suffix,
                     const MultiscaleOptions& options, Views* views);

// The same for samples.0 .. samples.K; `level_of_samples` as in BoardLog.
class LevelViews {
 public:
  LevelViews(const Views* wanted, int width, int height, int levels);
  bool wanted() const { return !views_.empty(); }
  void paste(const Board& board, const std::vector<CountImage>& level_of_samples);
  // `explored` [y][x], or empty: uniformly spent before there was a board.
  void hand_over(const CountImage& explored, Views& views);

 private:
  std::vector<View> views_;
};

}  // namespace spool
