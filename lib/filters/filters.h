// All filters of the library.
#pragma once

#include "lib/filters/filter.h"
#include "lib/methods/method_list.h"

namespace spool {

using FilterList = MethodList<FilterFunction>;

const FilterList& filters();

}  // namespace spool
