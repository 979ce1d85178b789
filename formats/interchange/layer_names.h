// The layers of formats/spool.md 10: which components and which semantic a name stands for.
#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "formats/dump_header.h"

namespace spool::interchange {

struct LayerName {
  std::vector<std::string> components;
  format::Semantic semantic = format::Semantic::kNotStated;
};

// nullopt for a name that the page does not list.
std::optional<LayerName> find_layer_name(std::string_view layer);

// Of the components of a layer, where they are not those that its name stands for; else empty.
std::vector<uint16_t> own_semantics(const format::DumpHeader& header, const std::string& layer);

std::vector<std::string> listed_layer_names();

// A lower-case letter, then lower-case letters, digits or '_'; at most 29 bytes, so that ".X" fits.
bool is_layer_name(std::string_view layer);

// Of one value per pixel in every recording: what images are judged by.
bool is_reference_layer(std::string_view layer);

}  // namespace spool::interchange
