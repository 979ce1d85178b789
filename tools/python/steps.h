// What the program's verbs do, one step each, for Python: replay, reconstruct, metrics, synth.
#pragma once

#include <nanobind/nanobind.h>

namespace spool::python {

void bind_source(nanobind::module_& module);
void bind_replay(nanobind::module_& module);
void bind_reconstruct(nanobind::module_& module);
void bind_metrics(nanobind::module_& module);
void bind_synth(nanobind::module_& module);

}  // namespace spool::python
