// What an importer hands over to be written: the layers of a recording as arrays of foreign files.
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include <nlohmann/json.hpp>

#include "formats/dump_header.h"
#include "formats/file_handle.h"
#include "formats/interchange/sample_array.h"
#include "lib/core/error.h"

namespace spool::interchange {

struct ForeignFile {
  std::string name;
  uint64_t bytes = 0;
  std::string sha256;
  std::filesystem::path path;
};

Result<ForeignFile> identify(const format::FileHandle& file);

// `meta.import` of a recording: which files it was made of, how, and what was converted or dropped.
// `independent`: "true", "false" or "unknown".
struct ImportRecord {
  std::string format;
  int version = 1;
  std::vector<ForeignFile> files;
  nlohmann::json options = nlohmann::json::object();
  std::vector<std::string> converted, dropped;
  std::string independent = "unknown";
};

// `half`: some numbers had 16 bits.
nlohmann::json to_json(const ImportRecord& record, bool half);

struct ForeignLayer {
  std::string name;
  std::vector<std::string> components;
  format::Scope scope = format::Scope::kSample;
  SampleArray array;
  std::vector<uint16_t> semantics = {};  // of the components; empty: as the name has it
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
