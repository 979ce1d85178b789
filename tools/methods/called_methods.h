// Methods that are functions of the program which holds this library: `python:NAME`.
//
// The Python module (tools/python) provides how they are called. Where it does not, as in the
// program `spool`, plans and results that name them can be read, and a run of them is an error
// (kUsage).
#pragma once

#include <functional>
#include <string>

#include "lib/filters/filter.h"
#include "lib/sampling/asked_counts.h"
#include "lib/sampling/sampler.h"
#include "tools/methods/statistics_file.h"

namespace spool::tools {

struct CalledMethods {
  std::function<Result<ReadySampler>(const std::string& name, const OptionValues&)> sampler;
  std::function<Result<ReadyFilter>(const std::string& name, const OptionValues&)> filter;
};

// For the whole process, once, before a method is made.
void provide_called_methods(CalledMethods methods);

// Errors: those of their provider.
Result<ReadySampler> make_called_sampler(const std::string& name, const OptionValues& set);
Result<ReadyFilter> make_called_filter(const std::string& name, const OptionValues& set);

// What a sampler that is asked for counts is given.
struct CalledOptions {
  AskedCountsOptions asked;
  ToldStatistics told;
};
const OptionTable<CalledOptions>& called_sampler_option_table();
const OptionTable<CalledOptions>& called_filter_option_table();

}  // namespace spool::tools
