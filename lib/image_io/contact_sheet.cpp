#include "lib/image_io/contact_sheet.h"

#include <algorithm>
#include <cmath>

#include <fmt/core.h>

#include "lib/image_io/bitmap_font.h"

namespace spool {
namespace {

constexpr Rgb8 kPaper = {24, 24, 26};
constexpr Rgb8 kInk = {232, 232, 228};
constexpr int kMargin = 12;
constexpr int kTextScale = 2;
constexpr int kLine = kGlyphHeight * kTextScale + 4;
constexpr int kBarHeight = 12;
constexpr int kLegendHeight = 3 * kLine;
constexpr int kMostColumns = 4;

std::string short_number(double value) {
  if (value == 0.0) return "0";
  const double magnitude = std::abs(value);
  return magnitude >= 1e4 || magnitude < 1e-3 ? fmt::format("{:.1e}", value)
                                              : fmt::format("{:.3g}", value);
}

void draw_fitting(Picture& target, const std::string& text, int left, int top, int width) {
  const auto fitting = static_cast<std::size_t>(std::max(4, width / (kGlyphAdvance * kTextScale)));
  const std::string shown = text.size() <= fitting ? text : text.substr(0, fitting - 2) + "..";
  draw_text(target, shown, left, top, kTextScale, kInk);
}

void draw_legend(Picture& target, const ColourBar& bar, int left, int top, int width) {
  for (int x = 0; x < width; ++x) {
    fill(target, left + x, top, 1, kBarHeight,
         sequential_colour(width > 1 ? static_cast<double>(x) / (width - 1) : 0.0));
  }
  const ValueRange& range = bar.range;
  const double middle =
      range.log ? std::sqrt(range.low * range.high) : 0.5 * (range.low + range.high);
  const int below = top + kBarHeight + 4;
  const std::string high = short_number(range.high);
  draw_text(target, short_number(range.low), left, below, kTextScale, kInk);
  if (range.high > range.low) {
    const std::string centre = short_number(middle);
    const std::string low = short_number(range.low);
    // The middle number is left out where the three would meet.
    const int longer = std::max(text_width(low, kTextScale), text_width(high, kTextScale));
    if (2 * longer + text_width(centre, kTextScale) + 4 * kGlyphAdvance <= width) {
      draw_text(target, centre, left + (width - text_width(centre, kTextScale)) / 2, below,
                kTextScale, kInk);
    }
    draw_text(target, high, left + width - text_width(high, kTextScale), below, kTextScale, kInk);
  }
  draw_fitting(target, bar.unit + (range.log ? ", log" : ""), left, below + kLine, width);
}

void draw_legend(Picture& target, const CategoryKey& key, int left, int top, int width) {
  int x = left;
  int y = top;
  for (const auto& [word, colour] : key.entries) {
    const int needed = kBarHeight + 6 + text_width(word, kTextScale) + 8;
    if (x > left && x + needed > left + width) {
      x = left;
      y += kLine;
    }
    fill(target, x, y, kBarHeight, kBarHeight, colour);
    draw_text(target, word, x + kBarHeight + 6, y, kTextScale, kInk);
    x += needed;
  }
}

void draw_legend(Picture& target, const DirectionKey&, int left, int top, int width) {
  // Five strokes in their own direction and colour say more than a strip would.
  constexpr int kStrokes = 4;
  const int cell = width / (kStrokes + 1);
  const double radius = 0.5 * kLine;
  for (int k = 0; k < kStrokes; ++k) {
    const double angle_deg = 180.0 * k / kStrokes;
    const double angle = angle_deg * 3.14159265358979 / 180.0;
    const double centre_x = left + cell * (k + 0.5);
    const double centre_y = top + radius;
    for (int step = -2 * kLine; step <= 2 * kLine; ++step) {
      const double t = 0.25 * step;  // pixels from the centre
      fill(target, static_cast<int>(centre_x + t * std::cos(angle)) - 1,
           static_cast<int>(centre_y + t * std::sin(angle)) - 1, 4, 4, direction_colour(angle_deg));
    }
    const std::string number = short_number(angle_deg);
    draw_text(target, number, static_cast<int>(centre_x) - text_width(number, kTextScale) / 2,
              top + kLine + 6, kTextScale, kInk);
  }
  const int x = left + cell * kStrokes;
  fill(target, x + cell / 2 - kBarHeight / 2, top + kLine / 4, kBarHeight, kBarHeight, kNeutral);
  draw_text(target, "none", x + (cell - text_width("none", kTextScale)) / 2, top + kLine + 6,
            kTextScale, kInk);
}

void draw_legend(Picture&, const NoLegend&, int, int, int) {}

void draw_legend(Picture& target, const Caption& caption, int left, int top, int width) {
  draw_fitting(target, caption.text, left, top, width);
}

int legend_height(const Panel& panel) {
  if (std::holds_alternative<NoLegend>(panel.legend)) return 0;
  return std::holds_alternative<Caption>(panel.legend) ? kLine : kLegendHeight;
}

int enlargement(const Picture& picture) {
  const int side = std::max(1, std::min(picture.width, picture.height));
  // A strip of 1 x 2000 pixels must not become 256 times as long.
  const int longest = std::max(1, std::max(picture.width, picture.height));
  return std::clamp((kMinPanelSide + side - 1) / side, 1, std::max(1, 4 * kMinPanelSide / longest));
}

struct PanelSize {
  int width = 0;
  int height = 0;
};

PanelSize panel_size(const Panel& panel) {
  const int factor = enlargement(panel.picture);
  return {std::max(kMinPanelSide, panel.picture.width * factor),
          kLine + panel.picture.height * factor + 6 + legend_height(panel)};
}

void draw_panel(Picture& target, const Panel& panel, int left, int top) {
  const int factor = enlargement(panel.picture);
  const int width = panel_size(panel).width;
  draw_fitting(target, panel.title, left, top, width);
  paste(target, enlarge(panel.picture, factor), left, top + kLine);
  const int below = top + kLine + panel.picture.height * factor + 6;
  std::visit([&](const auto& legend) { draw_legend(target, legend, left, below, width); },
             panel.legend);
}

}  // namespace

Picture contact_sheet(const std::string& heading, const std::vector<Panel>& panels) {
  // Rows as equal as possible: five panels stand as three and two, not as four and one.
  const int count = std::max(1, static_cast<int>(panels.size()));
  const int down = (count + kMostColumns - 1) / kMostColumns;
  const int across = (count + down - 1) / down;
  PanelSize cell;
  for (const Panel& panel : panels) {
    cell.width = std::max(cell.width, panel_size(panel).width);
    cell.height = std::max(cell.height, panel_size(panel).height);
  }
  const int top = heading.empty() ? kMargin : kMargin + kLine + 4;
  Picture sheet(kMargin + across * (cell.width + kMargin), top + down * (cell.height + kMargin),
                kPaper);
  if (!heading.empty()) draw_fitting(sheet, heading, kMargin, kMargin, sheet.width - 2 * kMargin);
  for (int i = 0; i < static_cast<int>(panels.size()); ++i) {
    draw_panel(sheet, panels[static_cast<std::size_t>(i)],
               kMargin + (i % across) * (cell.width + kMargin),
               top + (i / across) * (cell.height + kMargin));
  }
  return sheet;
}

Picture labelled_picture(const Panel& panel) {
  return contact_sheet("", {panel});
}

}  // namespace spool
