// One picture of several panels: a title above each, a legend with numbers below.
#pragma once

#include <string>
#include <utility>
#include <variant>
#include <vector>

#include "lib/image_io/picture.h"

namespace spool {

struct NoLegend {};
struct ColourBar {  // the sequential map with numbers
  ValueRange range;
  std::string unit;
};
struct CategoryKey {  // a square of colour and a word for each
  std::vector<std::pair<std::string, Rgb8>> entries;
};
struct DirectionKey {};  // the hue wheel with degrees
struct Caption {         // a line of text
  std::string text;
};

struct Panel {
  std::string title;
  Picture picture;
  std::variant<NoLegend, ColourBar, CategoryKey, DirectionKey, Caption> legend = NoLegend{};
};

// Pixels are repeated so that a panel is at least this many pixels wide and high.
inline constexpr int kMinPanelSide = 300;

// The panels from left to right under `heading`, at most four in a row.
Picture contact_sheet(const std::string& heading, const std::vector<Panel>& panels);

// One panel with its title and legend.
Picture labelled_picture(const Panel& panel);

}  // namespace spool
