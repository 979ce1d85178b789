// The module spool._core: what tools/python/spool makes its functions of.
#include <cstddef>
#include <cstdint>
#include <span>

#include <nanobind/nanobind.h>

#include "formats/crc32.h"
#include "formats/lost_pages.h"
#include "lib/core/check.h"
#include "tools/python/called_functions.h"
#include "tools/python/evaluation.h"
#include "tools/python/running.h"
#include "tools/python/showing.h"
#include "tools/python/steps.h"

namespace {

// As zlib.crc32, several times as fast: formats/python takes it where it stands beside this module.
std::uint32_t crc32(nanobind::handle bytes) {
  Py_buffer view{};
  if (PyObject_GetBuffer(bytes.ptr(), &view, PyBUF_SIMPLE) != 0) throw nanobind::python_error();
  const std::span held(static_cast<const std::byte*>(view.buf), static_cast<std::size_t>(view.len));
  std::uint32_t found = 0;
  {
    const nanobind::gil_scoped_release others;
    found = spool::format::crc32(held);
  }
  PyBuffer_Release(&view);
  return found;
}

}  // namespace

NB_MODULE(_core, module) {
  // What an interpreter still holds at its end is no leak worth a page of text.
  nanobind::set_leak_warnings(false);
  // A recording that is cut while it is mapped is an error, as in the program, and no SIGBUS.
  spool::format::survive_lost_pages();
  // Nor does an error of the library take the process with it.
  spool::throw_failed_checks();
  module.attr("version") = SPOOL_VERSION;
  module.def("call_methods_through", &spool::python::call_methods_through);
  module.def("check_called_options", &spool::python::check_called_options);
  module.def("end_all_work", &spool::python::end_all_work);
  module.def("forget_calls", &spool::python::forget_calls);
  module.def("crc32", &crc32);
  spool::python::bind_source(module);
  spool::python::bind_replay(module);
  spool::python::bind_reconstruct(module);
  spool::python::bind_metrics(module);
  spool::python::bind_synth(module);
  spool::python::bind_evaluate(module);
  spool::python::bind_methods(module);
  spool::python::bind_showing(module);
}
