// What the results of a plan say about its methods: DIR/statistics.json.
//
// Per recording, budget and number of threads: ranks with ties and paired differences with 95 %
// intervals, p-values adjusted by Holm's rule. Per recording and method: the slope of error over
// budget, and how many samples it needs for the error of uniform with box.
#pragma once

#include <filesystem>
#include <functional>
#include <string>
#include <vector>

#include "lib/core/error.h"
#include "lib/experiment/plan.h"
#include "lib/experiment/result_record.h"

namespace spool::tools {

// Reads the records of one recording at a time. `record` may fail: that cell has no result.
std::string statistics_json(const Plan& plan,
                            const std::function<Result<ResultRecord>(const Cell&)>& record);

}  // namespace spool::tools
