#include "tools/methods/called_methods.h"

#include <utility>

#include "lib/sampling/rounds.h"

namespace spool::tools {
namespace {

CalledMethods& provided() {
  static CalledMethods methods;
  return methods;
}

tl::unexpected<Error> nobody(const std::string& name) {
  return fail(ErrorCode::kUsage,
              "python:{}: is a function of a Python program: name it there, to spool.replay, "
              "spool.reconstruct or spool.evaluate",
              name);
}

}  // namespace

void provide_called_methods(CalledMethods methods) {
  provided() = std::move(methods);
}

Result<ReadySampler> make_called_sampler(const std::string& name, const OptionValues& set) {
  if (provided().sampler) return provided().sampler(name, set);
  return ReadySampler{
      [name](const SamplePool&, long long, const SamplingContext&) -> Result<SamplingResult> {
        return nobody(name);
      },
      {}};
}

Result<ReadyFilter> make_called_filter(const std::string& name, const OptionValues& set) {
  if (provided().filter) return provided().filter(name, set);
  return ReadyFilter{
      [name](const Selection&, const SamplePool&, const FilterContext&) -> Result<Reconstruction> {
        return nobody(name);
      },
      {}};
}

const OptionTable<CalledOptions>& called_sampler_option_table() {
  using O = AskedCountsOptions;
  static const OptionTable<CalledOptions> table = [] {
    OptionTable<CalledOptions> options;
    append_options(options,
                   OptionTable<O>{init_spp_option<O>(&O::init_spp),
                                  integer_option<O>("rounds", &O::rounds, 1, 1000,
                                                    "times that the function is asked")},
                   &CalledOptions::asked);
    for (Option<CalledOptions>& option : told_option_table(&CalledOptions::told))
      options.push_back(std::move(option));
    return options;
  }();
  return table;
}

const OptionTable<CalledOptions>& called_filter_option_table() {
  static const OptionTable<CalledOptions> table = told_option_table(&CalledOptions::told);
  return table;
}

}  // namespace spool::tools
