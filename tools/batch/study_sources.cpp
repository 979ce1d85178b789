#include "tools/batch/study_sources.h"

#include <limits>

#include "formats/spool_reader.h"
#include "lib/experiment/plan_cells.h"
#include "tools/methods/external_methods.h"
#include "tools/methods/replicate_images.h"

namespace spool::tools {

StudySources study_sources(const CellStore& store, const Plan& plan) {
  return {[&store, cells = PlanCells(plan)](const Cell& cell) {
            return store.read(cell_id(cells.number(cell)), cell);
          },
          [](const std::string& recording) {
            const auto reader = format::SpoolReader::open(recording);
            return reader ? static_cast<double>(reader->header().spp)
                          : std::numeric_limits<double>::quiet_NaN();
          },
          [](const MethodChoice& filter) {
            const Filter* method = find_method(known_filters(), filter.name);
            return method != nullptr && !method->needs.samples && !is_of_replicates(filter);
          }};
}

}  // namespace spool::tools
