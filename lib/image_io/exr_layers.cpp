#include "lib/image_io/exr_layers.h"

#include <algorithm>
#include <ranges>
#include <string_view>
#include <tuple>

#include <fmt/core.h>
#include <fmt/ranges.h>

#include "lib/core/counted.h"

namespace spool {
namespace {

constexpr std::size_t kListedNames = 8, kListedBytes = 160;

// Names of layers whose colours are identities: "cryptomatte/HASH/name".
std::vector<std::string> cryptomattes(const ExrPart& part) {
  std::vector<std::string> names;
  for (const auto& [key, text] : part.attributes.texts)
    if (key.starts_with("cryptomatte/") && key.ends_with("/name") && !text.empty())
      names.push_back(text);
  return names;
}

// The planes that are called R, G, B, else so in any letter case, or red, green, blue.
std::optional<std::array<std::size_t, 3>> colours(
    const std::map<std::string, std::size_t>& channels) {
  const auto r = channels.find("R"), g = channels.find("G"), b = channels.find("B");
  if (r != channels.end() && g != channels.end() && b != channels.end())
    return std::array{r->second, g->second, b->second};
  for (const auto& names : {std::array{"r", "g", "b"}, std::array{"red", "green", "blue"}}) {
    std::array<std::size_t, 3> found{};
    std::array<int, 3> times{};
    for (const auto& [channel, index] : channels) {
      for (std::size_t c = 0; c < 3; ++c) {
        if (lower_case(channel) != names[c]) continue;
        found[c] = index;
        ++times[c];
      }
    }
    if (times == std::array{1, 1, 1}) return found;
  }
  return std::nullopt;
}

// Y alone or beside an alpha; another channel only where it is alone.
std::optional<std::size_t> grey(const std::map<std::string, std::size_t>& channels) {
  std::vector<std::pair<std::string, std::size_t>> seen;
  for (const auto& [channel, index] : channels)
    if (lower_case(channel) != "a" && lower_case(channel) != "alpha")
      seen.emplace_back(channel, index);
  if (seen.size() != 1 || is_no_grey(seen[0].first)) return std::nullopt;
  if (channels.size() > 1 && seen[0].first != "Y") return std::nullopt;
  return seen[0].second;
}

// Takes the view off the end of `pass` and `before`.
void find_view(const ExrPart& part, ExrLayer& layer) {
  const auto known = [&](std::string_view word) {
    return std::find(part.views.begin(), part.views.end(), word) != part.views.end();
  };
  if (known(layer.pass)) {
    layer.view = layer.pass;
    std::tie(layer.before, layer.pass) = split_channel(layer.before);
  } else if (!part.view.empty()) {
    layer.view = part.view;
    if (layer.pass == part.view) {
      std::tie(layer.before, layer.pass) = split_channel(layer.before);
    } else if (layer.pass.size() > part.view.size() + 1 && layer.pass.ends_with(part.view) &&
               std::string_view("_- ").find(layer.pass[layer.pass.size() - part.view.size() - 1]) !=
                   std::string_view::npos) {
      layer.pass.resize(layer.pass.size() - part.view.size() - 1);
    }
  }
  // The first view is what a reader without views shows.
  if (!part.views.empty() && layer.view == part.views.front()) layer.view.clear();
}

void describe(const ExrPart& part, const std::vector<std::string>& mattes, ExrLayer& layer) {
  std::tie(layer.before, layer.pass) = split_channel(layer.name);
  find_view(part, layer);
  layer.kind = layer_kind(layer.pass);
  // "denoised" with the layer "rgba" in it: the part says it.
  const LayerKind by_part = layer_kind(split_channel(part.name).second);
  if ((layer.kind == LayerKind::kPicture || layer.kind == LayerKind::kUnknown) &&
      by_part != LayerKind::kPicture && by_part != LayerKind::kUnknown)
    layer.kind = by_part;
  for (const std::string& name : mattes)
    if (layer.name.starts_with(name)) layer.kind = LayerKind::kOther;
  layer.colour = colours(layer.channels);
  if (!layer.colour) layer.grey = grey(layer.channels);
}

// A channel of another name than Y is a picture only where the file has nothing else but an alpha.
void keep_lone_greys(const std::vector<ExrPart>& parts, std::vector<ExrLayer>& layers) {
  std::size_t channels = 0;
  for (const ExrPart& part : parts)
    for (const ExrChannel& channel : part.channels)
      channels += layer_kind(split_channel(channel.name).second) == LayerKind::kOther ||
                          lower_case(channel.name) == "a"
                      ? 0
                      : 1;
  for (ExrLayer& layer : layers)
    if (layer.grey && channels > 1 && parts[layer.part].channels[*layer.grey].name != "Y" &&
        !parts[layer.part].channels[*layer.grey].name.ends_with(".Y"))
      layer.grey.reset();
}

}  // namespace

std::pair<std::string, std::string> split_channel(const std::string& name) {
  const std::size_t dot = name.rfind('.');
  if (dot == std::string::npos) return {"", name};
  return {name.substr(0, dot), name.substr(dot + 1)};
}

std::vector<ExrLayer> layers_of(const std::vector<ExrPart>& parts) {
  std::vector<ExrLayer> layers;
  for (std::size_t p = 0; p < parts.size(); ++p) {
    std::map<std::string, std::map<std::string, std::size_t>> found;
    for (std::size_t c = 0; c < parts[p].channels.size(); ++c) {
      auto [layer, channel] = split_channel(parts[p].channels[c].name);
      found[layer.empty() ? parts[p].name : layer].emplace(std::move(channel), c);
    }
    const std::vector<std::string> mattes = cryptomattes(parts[p]);
    for (auto& [name, channels] : found) {
      ExrLayer layer;
      layer.part = p;
      layer.name = name;
      layer.channels = std::move(channels);
      describe(parts[p], mattes, layer);
      layers.push_back(std::move(layer));
    }
  }
  keep_lone_greys(parts, layers);
  return layers;
}

std::string spelt(const ExrLayer& layer) {
  const std::string& only = layer.channels.begin()->first;
  if (layer.channels.size() == 1) return layer.name.empty() ? only : layer.name + "." + only;
  if (!layer.name.empty()) return layer.name;
  if (!layer.colour) return fmt::format("{}", fmt::join(std::views::keys(layer.channels), ","));
  std::array<std::string_view, 3> names;
  for (const auto& [channel, index] : layer.channels)
    for (std::size_t c = 0; c < 3; ++c)
      if ((*layer.colour)[c] == index) names[c] = channel;
  return fmt::format("{}", fmt::join(names, ","));
}

std::string told(const ExrLayer& layer, const std::vector<ExrPart>& parts,
                 const std::vector<ExrLayer>& layers) {
  if (parts.size() == 1) return spelt(layer);  // whose layers have names of their own
  const bool twice = std::any_of(layers.begin(), layers.end(), [&](const ExrLayer& other) {
    return other.part != layer.part && other.name == layer.name;
  });
  if (!twice) return spelt(layer);
  return fmt::format("{} of part {} '{}'", spelt(layer), layer.part, parts[layer.part].name);
}

std::string listed(const std::vector<std::string>& names) {
  std::string text;
  for (std::size_t i = 0; i < names.size(); ++i) {
    if (i == kListedNames || text.size() + names[i].size() > kListedBytes) {
      if (i == 0) return counted(names.size(), "name");
      return text + fmt::format(" and {} more", names.size() - i);
    }
    text += (text.empty() ? "" : ", ") + names[i];
  }
  return text;
}

}  // namespace spool
