#include "tools/json/pixel_json.h"

#include <nlohmann/json.hpp>

#include "tools/json/json_text.h"

namespace spool::tools {
namespace {

using nlohmann::ordered_json;

ordered_json footprint_json(const Footprint& footprint) {
  ordered_json taps = ordered_json::array(), shapes = ordered_json::array();
  for (const auto& [place, tap] : footprint.taps) {
    if (tap.weight == 0.0) continue;
    ordered_json entry = {place.second, place.first, tap.weight};
    for (const double weighted : tap.weighted)
      entry.push_back(weighted / tap.weight);
    taps.push_back(std::move(entry));
  }
  for (const FootprintShape& shape : footprint.shapes)
    shapes.push_back(
        {{"size", shape.size}, {"direction", shape.direction}, {"widths", shape.widths}});
  return {{"taps", taps}, {"shapes", shapes}};
}

ordered_json pixel_json(const PixelAnswer& pixel) {
  ordered_json entry = {{"x", pixel.x},
                        {"y", pixel.y},
                        {"capacity", pixel.capacity},
                        {"recorded", pixel.recorded},
                        {"samples", pixel.samples},
                        {"mean", pixel.mean},
                        {"low", pixel.low},
                        {"high", pixel.high},
                        {"histogram",
                         {{"not_positive", pixel.histogram.not_positive},
                          {"edges", pixel.histogram.edges},
                          {"counts", pixel.histogram.counts}}}};
  if (!pixel.sampler.empty()) entry["sampler"] = pixel.sampler;
  if (pixel.taken) entry["taken"] = *pixel.taken;
  if (!pixel.filter.empty()) entry["filter"] = pixel.filter;
  if (!pixel.image) return entry;
  entry["image"] = *pixel.image;
  entry["footprint"] = pixel.footprint ? footprint_json(*pixel.footprint) : ordered_json();
  return entry;
}

}  // namespace

std::string pixel_text(const PixelAnswer& pixel) {
  return json_text(pixel_json(pixel));
}

std::string pixels_text(const std::vector<PixelAnswer>& pixels) {
  ordered_json list = ordered_json::array();
  for (const PixelAnswer& pixel : pixels)
    list.push_back(pixel_json(pixel));
  return json_text(list);
}

}  // namespace spool::tools
