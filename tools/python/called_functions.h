// Samplers and filters that are Python functions, as the library calls them.
#pragma once

#include <nanobind/nanobind.h>

namespace spool::python {

namespace nb = nanobind;

// `lookup(kind, name, {option: text})` gives the function of a name with its options: an object
// with `texts` ({option: text} of the table in tools/methods/called_methods.h), `moments` (numbers)
// and a method `ask`. Of a
// sampler it is called once a round with the statistics so far, of a filter once, as
// tools/python/spool/own_methods.py says.
void call_methods_through(nb::object lookup);

// Raises SpoolError where `texts` of such an object holds what the table does not allow.
void check_called_options(const nb::object& made);

}  // namespace spool::python
