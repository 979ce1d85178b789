// The layers of formats/spool.md 10: which components and which semantic a name stands for.
#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "formats/record_layout.h"

namespace spool::interchange {

struct LayerName {
  std::vector<std::string> components;
  format::Semantic semantic = format::Semantic::kNotStated;
};

// nullopt for a name that the page does not list.
std::optional<LayerName> find_layer_name(std::string_view layer);

std::vector<std::string> listed_layer_names();

// A lower-case letter, then lower-case letters, digits or '_'; at most 29 bytes, so that ".X" fits.
bool is_layer_name(std::string_view layer);

}  // namespace spool::interchange
