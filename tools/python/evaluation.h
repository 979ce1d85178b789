// `spool evaluate` of a plan, for Python, and the methods that it may name.
#pragma once

#include <nanobind/nanobind.h>

namespace spool::python {

void bind_evaluate(nanobind::module_& module);
void bind_methods(nanobind::module_& module);

}  // namespace spool::python
