#include "tools/methods/external_methods.h"

#include <algorithm>
#include <mutex>
#include <utility>

#include "formats/interchange/export_format.h"
#include "lib/experiment/stage_clock.h"
#include "lib/filters/filter_stage.h"
#include "lib/filters/given_image.h"
#include "lib/filters/oidn/oidn.h"
#include "lib/image_io/counts_exr.h"
#include "lib/image_io/foreign_picture.h"
#include "lib/sampling/asked_counts.h"
#include "lib/sampling/given_counts.h"
#include "lib/sampling/rounds.h"
#include "lib/sampling/spending.h"
#include "tools/methods/called_methods.h"
#include "tools/methods/ensemble_filter.h"
#include "tools/methods/external_process.h"
#include "tools/methods/replicate_images.h"
#include "tools/methods/selection_file.h"
#include "tools/methods/statistics_file.h"
#include "tools/methods/watched_process.h"
#include "tools/terminal/console.h"

namespace spool::tools {
namespace {

struct NoOptions {};

struct ExecOptions {
  double timeout = 600.0;
  ToldStatistics told;
};

struct ExecSamplerOptions {
  ExecOptions exec;
  AskedCountsOptions asked;
};

const OptionTable<ExecOptions>& exec_option_table() {
  using O = ExecOptions;
  static const OptionTable<O> table = [] {
    OptionTable<O> options = told_option_table(&O::told);
    options.insert(options.begin(),
                   number_option<O>("timeout", &O::timeout, 0.001, 1e6,
                                    "seconds that one call of the command may take"));
    return options;
  }();
  return table;
}

const OptionTable<ExecSamplerOptions>& exec_sampler_option_table() {
  using O = AskedCountsOptions;
  static const OptionTable<ExecSamplerOptions> table = [] {
    OptionTable<ExecSamplerOptions> options;
    append_options(options,
                   OptionTable<O>{init_spp_option<O>(&O::init_spp),
                                  integer_option<O>("rounds", &O::rounds, 1, 1000,
                                                    "times that the command is asked")},
                   &ExecSamplerOptions::asked);
    append_options(options, exec_option_table(), &ExecSamplerOptions::exec);
    return options;
  }();
  return table;
}

Needs needs_of(const ExecOptions& options) {
  return {.features = options.told.features ? Use::kWhenRecorded : Use::kNone};
}

Needs made_elsewhere() {
  return {.samples = false};
}

// What a command answered, and how long starting it and handing files over took.
template <class Value>
struct Answer {
  Value value;
  double exchange_seconds = 0;
};

// One call: the statistics go out, and `read` takes the EXR that the command wrote.
template <class Value>
Result<Answer<Value>> call(const std::string& command, const PieceStatistics& statistics,
                           const SamplePool& pool, const ExecOptions& options,
                           std::vector<std::pair<std::string, std::string>> environment,
                           const std::function<Result<Value>(const std::filesystem::path&)>& read) {
  SPOOL_ASSIGN(const ExchangeFolder folder, ExchangeFolder::create());
  const std::filesystem::path input = folder / "statistics.exr", output = folder / "answer.exr";
  const StageClock writing;
  SPOOL_TRY(write_statistics(input, statistics, pool, options.told));
  double exchange = writing.elapsed().wall;
  SPOOL_ASSIGN(const ExternalTimes times, run_external({command,
                                                        {input.string(), output.string()},
                                                        std::move(environment),
                                                        options.timeout,
                                                        folder.path()}));
  exchange += times.start;
  std::error_code status;
  if (!std::filesystem::exists(output, status)) {
    return fail(ErrorCode::kData,
                "exec:{}: wrote no answer: it must write an EXR to the path that is its last "
                "argument",
                command);
  }
  const StageClock reading;
  Result<Value> answer = read(output);
  if (answer) return Answer<Value>{std::move(*answer), exchange + reading.elapsed().wall};
  std::string message = answer.error().message;
  if (message.starts_with(output.string()))
    message = "answer" + message.substr(output.string().size());
  return fail(ErrorCode::kData, "exec:{}: {}", command, message);
}

Result<ReadySampler> make_exec_sampler(const std::string& command, const OptionValues& set) {
  SPOOL_ASSIGN(const ExecSamplerOptions options,
               with_options(exec_sampler_option_table(), ExecSamplerOptions{}, set));
  const SamplerFunction run = [command, options](const SamplePool& pool, long long budget,
                                                 const SamplingContext& context) {
    double exchange = 0.0;
    const AskForCounts ask = [&](const CountQuestion& question) -> Result<CountImage> {
      SPOOL_ASSIGN(const auto answer,
                   call<ExrFile>(command, question.statistics, question.pool, options.exec,
                                 {{"SPOOL_ROUND", std::to_string(question.round)},
                                  {"SPOOL_ROUNDS", std::to_string(question.rounds)},
                                  {"SPOOL_LEFT", std::to_string(question.left)},
                                  {"SPOOL_SHARE", std::to_string(question.share)},
                                  {"SPOOL_SEED", std::to_string(question.seed)}},
                                 [&](const std::filesystem::path& path) {
                                   return read_counts_exr(path, NeededSize{question.pool.width(),
                                                                           question.pool.height()});
                                 }));
      exchange += answer.exchange_seconds;
      return counts_from_exr(answer.value, fmt::format("exec:{}: answer", command));
    };
    Result<SamplingResult> result = sample_asked_counts(pool, budget, options.asked, ask, context);
    if (!result && !result.error().message.starts_with("exec:")) {
      return Result<SamplingResult>(
          fail(result.error().code, "exec:{}: {}", command, result.error().message));
    }
    if (result) result->log.exchange_seconds = exchange;
    return result;
  };
  return ReadySampler{run, needs_of(options.exec)};
}

Result<ReadyFilter> make_exec_filter(const std::string& command, const OptionValues& set) {
  SPOOL_ASSIGN(const ExecOptions options, with_options(exec_option_table(), ExecOptions{}, set));
  const FilterFunction run = [command, options](const Selection& selection, const SamplePool& pool,
                                                const FilterContext&) -> Result<Reconstruction> {
    const std::string name = fmt::format("exec:{}: answer", command);
    SPOOL_ASSIGN(auto answer, call<ForeignPicture>(command, selection.statistics, pool, options, {},
                                                   [&](const std::filesystem::path& path) {
                                                     return read_picture(
                                                         path, kNoLayerOption,
                                                         size_of(pool));  // no option chooses
                                                   }));
    SPOOL_ASSIGN(Reconstruction own, own_image(std::move(answer.value.rgb), pool, name));
    own.exchange_seconds = answer.exchange_seconds;
    return own;
  };
  return ReadyFilter{run, needs_of(options)};
}

Result<ReadySampler> make_counts_sampler(const std::string& path, const OptionValues& set) {
  SPOOL_TRY(with_options(OptionTable<NoOptions>{}, NoOptions{}, set));
  SPOOL_ASSIGN(SelectionFile file, read_selection(path));
  const SamplerFunction run = [file = std::move(file), path](
                                  const SamplePool& pool, long long budget,
                                  const SamplingContext& context) -> Result<SamplingResult> {
    if (const long long counts = count_samples(file.n); counts > budget) {
      return fail(ErrorCode::kData,
                  "counts:{}: {} samples, the budget has {}: give --spp {} or take fewer", path,
                  counts, budget,
                  static_cast<double>(counts) /
                      (static_cast<double>(pool.recording().width()) * pool.recording().height()));
    }
    SPOOL_ASSIGN(SamplingResult result,
                 sample_given_counts(pool, budget, file.n, "counts:" + path, context));
    result.selection.attenuation = file.attenuation;
    if (file.signal) set_signal(result.selection.statistics, pool, *file.signal);
    return result;
  };
  return ReadySampler{run, {}};
}

struct ImageOptions {
  LayerChoice layer = {"", "", "--set filter.layer=", "--set filter.part="};
  std::string replicate;
};

const OptionTable<ImageOptions>& image_option_table() {
  using O = ImageOptions;
  static const OptionTable<O> table = [] {
    OptionTable<O> options = {interchange::text_option<O>(
        "replicate", &O::replicate, "N", "what {replicate} of the name is; evaluate fills it in")};
    append_options(options,
                   OptionTable<LayerChoice>{
                       interchange::text_option<LayerChoice>(
                           "layer", &LayerChoice::layer, "NAME",
                           "the layer that is the image, where several may be"),
                       interchange::text_option<LayerChoice>("part", &LayerChoice::part, "NAME|N",
                                                             "the part of the file that has it")},
                   &O::layer);
    return options;
  }();
  return table;
}

// Read for the first recording that has its size: a small file may claim a huge picture.
struct KeptImage {
  std::mutex mutex;
  FilterFunction filter;
};

Result<ReadyFilter> make_image_filter(const std::string& path, const OptionValues& set) {
  SPOOL_ASSIGN(const ImageOptions options, with_options(image_option_table(), {}, set));
  if (is_of_replicates({"image", path, {}}) || !options.replicate.empty())
    return replicate_image_filter(path, options.replicate, options.layer);
  SPOOL_ASSIGN(const ForeignPicture header, read_picture_header(path, options.layer));
  print_note(remark_line("image:" + path, header.remarks));
  const auto kept = std::make_shared<KeptImage>();
  return ReadyFilter{[=](const Selection& selection, const SamplePool& pool,
                         const FilterContext& context) -> Result<Reconstruction> {
                       {
                         const std::scoped_lock lock(kept->mutex);
                         if (!kept->filter) {
                           SPOOL_ASSIGN(ForeignPicture picture,
                                        read_picture(path, options.layer, size_of(pool)));
                           kept->filter = given_image(std::move(picture.rgb), "image:" + path);
                         }
                       }
                       return kept->filter(selection, pool, context);
                     },
                     made_elsewhere()};
}

Result<ReadyFilter> make_known_ensemble(const std::string& parts, const OptionValues& set) {
  return make_ensemble_filter(known_filters(), parts, set);
}

// A method whose argument stands where others have a preset.
template <class Function, class Options>
Method<Function> method_with_argument(std::string name, std::string argument, std::string summary,
                                      const OptionTable<Options>& table, Needs needs,
                                      Result<Ready<Function>> (*make)(const std::string&,
                                                                      const OptionValues&)) {
  Method<Function> method;
  method.name = name;
  method.argument = argument;
  method.summary = std::move(summary);
  method.needs = std::move(needs);
  method.describe = [table](std::string_view) { return describe_options(table, Options{}); };
  method.make = [=](std::string_view given, const OptionValues& set) -> Result<Ready<Function>> {
    if (given.empty()) {
      return fail(ErrorCode::kUsage, "write {}:{}", name, argument);
    }
    return make(std::string(given), set);
  };
  return method;
}

}  // namespace

std::vector<MethodChoice> with_inner_methods(const MethodChoice& method) {
  std::vector<MethodChoice> all = {method};
  std::vector<std::string> inner;
  if (method.name == "ensemble") inner = ensemble_parts(method.preset);
  for (const auto& [name, value] : method.set)
    if (name == "filter") inner.push_back(value);
  for (const std::string& text : inner)
    if (const auto choice = choose_method(known_filters(), text))
      for (MethodChoice& found : with_inner_methods(*choice))
        all.push_back(std::move(found));
  return all;
}

bool is_foreign_code(const MethodChoice& method) {
  return std::ranges::any_of(with_inner_methods(method),
                             [](const MethodChoice& inner) { return inner.name == "exec"; });
}

bool runs_alone(const MethodChoice& method) {
  return std::ranges::any_of(with_inner_methods(method), [](const MethodChoice& inner) {
    return inner.name == "exec" || inner.name == "python";
  });
}

const SamplerList& known_samplers() {
  static const SamplerList all = [] {
    SamplerList list = samplers();
    list.other_kind = filters().kind;
    list.other_names = names_of(filters());
    list.methods.push_back(method_with_argument(
        "counts", "FILE.exr", "your own: an image with the number of samples of each piece",
        OptionTable<NoOptions>{}, Needs{}, &make_counts_sampler));
    list.methods.push_back(method_with_argument(
        "exec", "COMMAND", "your own: a command that is asked for counts, round after round",
        exec_sampler_option_table(), Needs{}, &make_exec_sampler));
    list.methods.push_back(
        method_with_argument("python", "NAME", "your own: a function of a Python program",
                             called_sampler_option_table(), Needs{}, &make_called_sampler));
    return list;
  }();
  return all;
}

const FilterList& known_filters() {
  static const FilterList all = [] {
    FilterList list = filters();
    list.other_kind = samplers().kind;
    list.other_names = names_of(samplers());
    list.methods.push_back(with_stage_options(oidn_filter()));
    list.methods.push_back(with_stage_options(method_with_argument(
        "ensemble", "A+B",
        "the mean of two to four filters, or weighted by two halves of the samples",
        ensemble_option_table(), Needs{}, &make_known_ensemble)));
    list.methods.push_back(with_stage_options(
        method_with_argument("image", "FILE.exr", "your own: an image that was made elsewhere",
                             image_option_table(), made_elsewhere(), &make_image_filter)));
    list.methods.push_back(with_stage_options(method_with_argument(
        "exec", "COMMAND", "your own: a command that makes the image from the statistics",
        exec_option_table(), Needs{}, &make_exec_filter)));
    list.methods.push_back(with_stage_options(
        method_with_argument("python", "NAME", "your own: a function of a Python program",
                             called_filter_option_table(), Needs{}, &make_called_filter),
        OwnOptions::kKnownWhenMade));
    return list;
  }();
  return all;
}

}  // namespace spool::tools
