#include "tools/python/evaluation.h"

#include <nanobind/stl/optional.h>
#include <nanobind/stl/string.h>
#include <nanobind/stl/vector.h>

#include "lib/experiment/loop_filter.h"
#include "lib/experiment/plan_reader.h"
#include "tools/batch/evaluation_run.h"
#include "tools/batch/run_tasks.h"
#include "tools/methods/external_methods.h"
#include "tools/python/running.h"
#include "tools/verbs/mask_files.h"

namespace spool::python {
namespace {

Result<tools::RunRequest> request_of(const std::string& plan, const std::string& name,
                                     const std::string& folder, const std::string& output) {
  const SamplerList& samplers = tools::known_samplers();
  const FilterList& filters = tools::known_filters();
  tools::RunRequest request;
  SPOOL_ASSIGN(request.plan, parse_plan(plan, name, folder, {samplers, filters}));
  SPOOL_TRY(tools::read_masks(request.plan));
  SPOOL_TRY(check_loop_filters(samplers, request.plan.samplers, filters, request.plan.filters));
  request.folder = output;
  return request;
}

void evaluated(const std::string& plan, const std::string& name, const std::string& folder,
               const std::string& output, bool force, bool exact_timing,
               const std::optional<std::vector<std::string>>& only, bool merge, int threads,
               const nb::object& progress) {
  tools::CommonOptions common;
  common.force = force;
  common.quiet = true;
  run_watched(
      [&](Watch& watch) -> Result<void> {
        SPOOL_ASSIGN(tools::RunRequest request, request_of(plan, name, folder, output));
        request.exact_timing = exact_timing;
        request.only = only;
        request.merge = merge;
        request.progress = [&](double share, std::size_t done, std::size_t of) {
          watch.update(share, done, of);
        };
        request.cancelled = [&] { return watch.stopped(); };
        return tools::run_plan(request, common);
      },
      progress, threads);
}

// What is left of a plan: (recording, names of cells, expected CPU seconds) of each sampling run,
// the most expensive first; how many cells are done; how many threads a task needs (0: any).
nb::tuple tasks(const std::string& plan, const std::string& name, const std::string& folder,
                const std::string& output) {
  const tools::TasksLeft left = run<tools::TasksLeft>(
      [&](Watch&) -> Result<tools::TasksLeft> {
        SPOOL_ASSIGN(const tools::RunRequest request, request_of(plan, name, folder, output));
        return tools::tasks_left(request);
      },
      nb::none(), 0);
  nb::list listed;
  for (const tools::RunTask& task : left.tasks)
    listed.append(nb::make_tuple(task.dump, task.ids, task.cost));
  return nb::make_tuple(listed, left.done, left.threads);
}

template <class List>
nb::list described(const List& list) {
  nb::list methods;
  for (const auto& method : list) {
    nb::dict options, readings, views, entry;
    for (const OptionDescription& option : method.describe(""))
      options[nb::str(option.name.c_str())] =
          nb::make_tuple(option.value, option.allowed, option.help);
    for (const Reading& reading : method.readings)
      readings[nb::str(reading.name.c_str())] = nb::make_tuple(reading.of, reading.summary);
    for (const ViewDescription& view : method.views)
      views[nb::str(view.name.c_str())] = view.meaning;
    entry["name"] = method.name;
    entry["summary"] = method.summary;
    entry["argument"] = method.argument;
    entry["presets"] = nb::cast(method.presets);
    entry["options"] = options;
    entry["readings"] = readings;
    entry["views"] = views;
    methods.append(entry);
  }
  return methods;
}

}  // namespace

void bind_evaluate(nb::module_& module) {
  module.def("evaluate", &evaluated, nb::arg("plan"), nb::arg("name"), nb::arg("folder"),
             nb::arg("output"), nb::arg("force"), nb::arg("exact_timing"), nb::arg("only").none(),
             nb::arg("merge"), nb::arg("threads"), nb::arg("progress").none());
  module.def("tasks", &tasks, nb::arg("plan"), nb::arg("name"), nb::arg("folder"),
             nb::arg("output"));
}

void bind_methods(nb::module_& module) {
  module.def("samplers", [] { return described(tools::known_samplers()); });
  module.def("filters", [] { return described(tools::known_filters()); });
}

}  // namespace spool::python
