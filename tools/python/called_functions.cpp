#include "tools/python/called_functions.h"

#include <nanobind/stl/string.h>
#include <nanobind/stl/vector.h>

#include <memory>
#include <optional>
#include <string>
#include <utility>

#include "lib/filters/given_image.h"
#include "lib/kernels/piece_estimates.h"
#include "lib/sampling/rounds.h"
#include "lib/statistics/feature_statistics.h"
#include "lib/statistics/transformed_moments.h"
#include "tools/methods/called_methods.h"
#include "tools/python/arrays.h"
#include "tools/python/left_alone.h"
#include "tools/python/running.h"

namespace spool::python {
namespace {

// A Python object that any thread may let go.
using Held = std::shared_ptr<const nb::object>;

Held hold(nb::object object) {
  return {new nb::object(std::move(object)), [](const nb::object* held) {
            const nb::gil_scoped_acquire lock;
            delete held;
          }};
}

std::string text_of(const nb::handle& value) {
  try {
    const nb::object bytes = nb::str(value).attr("encode")("utf-8", "backslashreplace");
    return nb::cast<nb::bytes>(bytes).c_str();
  } catch (nb::python_error&) {  // of an exception whose __str__ raises
    return "";
  }
}

// What a function raised, as the error of its method; thrown on where it is meant for the code that
// began the work.
Error error_of(const std::string& name, nb::python_error& error, Watch* watch) {
  if (watch != nullptr && !error.matches(PyExc_Exception)) {
    if (!watch->raised) watch->raised.emplace(error);
    watch->stop();
    throw WorkStopped{};
  }
  const std::string type = text_of(error.type().attr("__name__"));
  const std::string begin = fmt::format("python:{}: ", name);
  const bool own = type == "SpoolError";
  if (watch != nullptr) watch->failures.try_emplace(begin, error);
  return fail(own ? ErrorCode::kUsage : ErrorCode::kData, "{}{}{}", begin, own ? "" : type + ": ",
              text_of(error.value()))
      .value();
}

// `work` with the interpreter's lock; what it raises becomes the error of the method.
template <class Work>
auto with_python(const std::string& name, Watch* watch, Work&& work) -> decltype(work()) {
  std::optional<decltype(work())> result;
  survive_the_end([&] {
    const nb::gil_scoped_acquire lock;
    try {
      result = work();
    } catch (nb::python_error& error) {
      result = tl::unexpected<Error>(error_of(name, error, watch));
    }
  });
  return std::move(*result);
}

struct CalledFunction {
  std::string name;
  tools::CalledOptions options;
  Held function;
  std::shared_ptr<Watch> watch;  // of the work that it is a part of; null in a thread of a result
};

// What the decorator or a call set, by the table that the program has for it.
Result<tools::CalledOptions> options_of(const nb::object& made) {
  OptionValues set;
  for (const auto& [option, text] : nb::cast<nb::dict>(made.attr("texts")))
    set.emplace_back(nb::cast<std::string>(option), nb::cast<std::string>(text));
  SPOOL_ASSIGN(tools::CalledOptions options,
               with_options(tools::called_sampler_option_table(), {}, set));
  options.told.moments = nb::cast<std::vector<double>>(made.attr("moments"));
  return options;
}

Result<CalledFunction> look_up(const Held& lookup, const char* kind, const std::string& name,
                               const OptionValues& set) {
  const std::shared_ptr<Watch> watch = Watch::current();
  if (watch && watch->is_called_back()) {
    return fail(ErrorCode::kUsage,
                "python:{}: asked for by a function of one's own: such a function may call the "
                "methods of the library, and none like itself",
                name);
  }
  return with_python(name, watch.get(), [&]() -> Result<CalledFunction> {
    nb::dict options;
    for (const auto& [option, text] : set)
      options[nb::str(option.c_str())] = text;
    const nb::object made = (*lookup)(kind, name, options);
    SPOOL_ASSIGN(tools::CalledOptions chosen, options_of(made));
    return CalledFunction{name, std::move(chosen), hold(made), watch};
  });
}

Needs needs_of(const CalledFunction& called) {
  return {.features = called.options.told.features ? Use::kWhenRecorded : Use::kNone};
}

// What a function gets of the samples taken so far, before the interpreter is asked for.
struct Known {
  PieceEstimates pieces;
  CountImage left;
  std::vector<FeatureStatistics> features;
  std::vector<std::pair<double, TransformedMoments>> moments;  // by lambda
};

Result<Known> known_of(const PieceStatistics& statistics, const SamplePool& pool,
                       const tools::ToldStatistics& told) {
  GuardCounts guards;  // of a copy for others
  Known known;
  SPOOL_ASSIGN(known.pieces, estimate_pieces(statistics, {}, statistics.signal.exposure, guards));
  known.left = CountImage(statistics.width(), statistics.height());
  for (int y = 0; y < known.left.height(); ++y) {
    for (int x = 0; x < known.left.width(); ++x)
      known.left(x, y) = pool.capacity(x, y) - statistics.n(x, y);
  }
  if (told.features) {
    SPOOL_ASSIGN(known.features, feature_statistics(pool, statistics.n, guards));
  }
  for (const double lambda : told.moments) {
    known.moments.emplace_back(
        lambda, transformed_moments(pool, statistics.n, 1.0, lambda, HighestMoment::kFourth));
  }
  return known;
}

nb::list list_of(const std::vector<Plane>& planes) {
  nb::list channels;
  for (const Plane& channel : planes)
    channels.append(plane_to_numpy(channel));
  return channels;
}

nb::dict to_python(const Known& known, const CountImage& n) {
  nb::dict told, features, variances, moments;
  told["mean"] = rgb_to_numpy(known.pieces.mean);
  told["variance"] = rgb_to_numpy(known.pieces.variance);
  told["n"] = counts_to_numpy(n);
  told["left"] = counts_to_numpy(known.left);
  for (const FeatureStatistics& feature : known.features) {
    const nb::str name(feature.layer.name.c_str());
    features[name] = list_of(feature.mean);
    variances[name] = list_of(feature.variance);
  }
  told["features"] = features;
  told["feature_variances"] = variances;
  for (const auto& [lambda, of] : known.moments) {
    nb::dict one;
    one["mean"] = rgb_to_numpy(of.mean);
    one["m2"] = rgb_to_numpy(of.m2);
    one["m3"] = rgb_to_numpy(of.m3);
    one["m4"] = rgb_to_numpy(of.m4);
    moments[nb::float_(lambda)] = one;
  }
  told["moments"] = moments;
  return told;
}

// Whole numbers are wants; other numbers are shares of this round's part of the budget.
Result<CountImage> answer_of(const nb::object& answer, const CountQuestion& question,
                             const std::string& name) {
  CountArray counts;
  if (nb::try_cast(answer, counts, false)) return counts_from_numpy(counts, "python:" + name);
  const auto weights = nb::cast<nb::ndarray<const double, nb::ndim<2>, nb::c_contig>>(answer);
  Plane shares(static_cast<int>(weights.shape(1)), static_cast<int>(weights.shape(0)));
  const CountImage& n = question.statistics.n;
  if (!shares.same_size(n)) return CountImage(shares.width(), shares.height());
  std::copy_n(weights.data(), shares.size(), shares.pixels().begin());
  return hand_out(shares, n, question.pool, question.share);
}

Result<CountImage> ask(const CalledFunction& called, const CountQuestion& question) {
  SPOOL_ASSIGN(const Known known,
               known_of(question.statistics, question.pool, called.options.told));
  return with_python(called.name, called.watch.get(), [&]() -> Result<CountImage> {
    nb::dict told = to_python(known, question.statistics.n);
    told["round"] = question.round;
    told["rounds"] = question.rounds;
    told["budget_left"] = question.left;
    told["share"] = question.share;
    told["seed"] = question.seed;
    return answer_of(answer_to(std::move(told), *called.function, called.watch), question,
                     called.name);
  });
}

Result<ReadySampler> sampler_of(const CalledFunction& called) {
  const SamplerFunction run = [called](const SamplePool& pool, long long budget,
                                       const SamplingContext& context) {
    Result<SamplingResult> result = sample_asked_counts(
        pool, budget, called.options.asked,
        [&](const CountQuestion& question) { return ask(called, question); }, context);
    if (result || result.error().message.starts_with("python:")) return result;
    return Result<SamplingResult>(
        fail(result.error().code, "python:{}: {}", called.name, result.error().message));
  };
  return ReadySampler{run, needs_of(called)};
}

Result<RgbImage> image_of(const CalledFunction& called, const Known& known, const CountImage& n) {
  return with_python(called.name, called.watch.get(), [&]() -> Result<RgbImage> {
    return rgb_from_numpy(
        nb::cast<ImageArray>(answer_to(to_python(known, n), *called.function, called.watch)));
  });
}

Result<ReadyFilter> filter_of(const CalledFunction& called) {
  const FilterFunction run = [called](const Selection& selection, const SamplePool& pool,
                                      const FilterContext&) -> Result<Reconstruction> {
    SPOOL_ASSIGN(const Known known, known_of(selection.statistics, pool, called.options.told));
    SPOOL_ASSIGN(RgbImage image, image_of(called, known, selection.statistics.n));
    return own_image(std::move(image), pool, "python:" + called.name + ": answer");
  };
  return ReadyFilter{run, needs_of(called)};
}

}  // namespace

void check_called_options(const nb::object& made) {
  if (const auto options = options_of(made); !options) raise(options.error());
}

void call_methods_through(nb::object lookup) {
  // Never let go: the list of methods ends after the interpreter.
  const Held held(new nb::object(std::move(lookup)), [](const nb::object*) {});
  tools::provide_called_methods(
      {[held](const std::string& name, const OptionValues& set) -> Result<ReadySampler> {
         SPOOL_ASSIGN(const CalledFunction called, look_up(held, "sampler", name, set));
         return sampler_of(called);
       },
       [held](const std::string& name, const OptionValues& set) -> Result<ReadyFilter> {
         SPOOL_ASSIGN(const CalledFunction called, look_up(held, "filter", name, set));
         return filter_of(called);
       }});
}

}  // namespace spool::python
