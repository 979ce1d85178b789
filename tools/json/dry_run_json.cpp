#include "tools/json/dry_run_json.h"

#include <nlohmann/json.hpp>

#include "tools/json/json_text.h"

namespace spool::tools {

std::string dry_run_text(const DryRun& run) {
  nlohmann::ordered_json layers = nlohmann::ordered_json::array();
  for (const UnusedLayers& one : run.unused)
    layers.push_back({{"recording", one.recording}, {"layers", one.layers}, {"share", one.share}});
  return json_text({{"cells", run.cells},
                    {"done", run.done},
                    {"left", run.left},
                    {"seconds", run.seconds},
                    {"left_of_unknown_time", run.unknown_time},
                    {"unused_layers", layers}});
}

}  // namespace spool::tools
