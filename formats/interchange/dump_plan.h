// What an importer hands over to be written: the layers of a recording as arrays of foreign files.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include <nlohmann/json.hpp>

#include "formats/dump_header.h"
#include "formats/interchange/import_record.h"
#include "formats/interchange/sample_array.h"

namespace spool::interchange {

struct ForeignLayer {
  std::string name;
  std::vector<std::string> components;
  format::Scope scope = format::Scope::kSample;
  SampleArray array;
};

struct DumpPlan {
  uint32_t width = 0, height = 0, spp = 0;
  format::SampleOrder sample_order = format::SampleOrder::kRenderer;
  bool shuffled = false;  // by the importer: images are none of the source's, and prove nothing
  std::vector<ForeignLayer> layers;  // radiance first
  nlohmann::json meta = nlohmann::json::object();
  ImportRecord record;
};

}  // namespace spool::interchange
