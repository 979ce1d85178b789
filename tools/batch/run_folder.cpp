#include "tools/batch/run_folder.h"

#include <algorithm>
#include <array>
#include <chrono>
#include <iterator>
#include <limits>
#include <numeric>

#include "formats/spool_reader.h"
#include "formats/temporary_file.h"
#include "lib/experiment/plan_reader.h"
#include "lib/experiment/reference.h"
#include "tools/batch/evaluation_pictures.h"
#include "tools/batch/run_manifest.h"
#include "tools/methods/external_methods.h"
#include "tools/methods/replicate_images.h"

namespace spool::tools {

namespace fs = std::filesystem;

namespace {

// Other shards may write on machines whose locks are not seen from here.
constexpr std::chrono::seconds kAgeBesideShards{3600};

// What killed runs left of files that they were writing: here, in cells/ and beside the pictures.
void sweep(const fs::path& folder, std::chrono::seconds age) {
  format::sweep_temporary_files(folder, age);
  std::error_code status;
  for (const auto& entry : fs::directory_iterator(folder, status)) {
    std::error_code ignored;
    if (entry.is_directory(ignored) && !entry.is_symlink(ignored)) {
      format::sweep_temporary_files(entry.path(), age);
    }
  }
}

// Replicates of a group are counted together, as of one recording that is longer: so its
// recordings have one size and one number of samples, and are judged by one kind of reference.
Result<void> check_alike(const PlanScene& scene, const std::string& other, const Plan& plan) {
  SPOOL_ASSIGN(const format::SpoolReader a, format::SpoolReader::open(scene.recordings.front()));
  SPOOL_ASSIGN(const format::SpoolReader b, format::SpoolReader::open(other));
  const auto differ = [&](const std::string& first, const std::string& second) {
    return fail(ErrorCode::kData,
                "{}: {}, but {} of the same group \"{}\" {}: a group is of recordings of one "
                "scene, made alike; give this one a group of its own",
                other, second, scene.recordings.front(), scene.group, first);
  };
  const auto size = [](const format::DumpHeader& h) {
    return fmt::format("has {} x {} pixels with {} samples", h.width, h.height, h.spp);
  };
  if (size(a.header()) != size(b.header())) return differ(size(a.header()), size(b.header()));
  const auto judged = [](const format::SpoolReader& r) {
    return std::string(r.find_layer("reference") ? "has a reference of its own" : "has none");
  };
  if (!plan.experiment.reference && judged(a) != judged(b)) return differ(judged(a), judged(b));
  return {};
}

// A sampler that is offered less than the budget would be judged as if it had had all of it.
Result<void> check_judging(const Plan& plan, const std::string& dump,
                           const format::SpoolReader& reader) {
  const auto recorded = static_cast<int>(reader.header().spp);
  const bool has_reference = reader.find_layer("reference").has_value();
  const ReferenceKind kind =
      plan.experiment.reference.value_or(default_reference_kind(recorded, has_reference));
  const int pieces_per_side = plan.experiment.pieces_per_side;
  const int withheld = withheld_samples(kind, recorded, plan.experiment.holdout, pieces_per_side);
  SPOOL_TRY(check_can_judge(kind, dump, has_reference, withheld, pieces_per_side));
  const int offered =
      std::max(0, offered_samples(kind, recorded, plan.experiment.holdout, pieces_per_side));
  for (const double spp : plan.spp) {
    if (spp <= offered) continue;
    const std::string judge =
        offered < recorded
            ? fmt::format(", of which samplers are offered {} ({})", offered, reference_name(kind))
            : "";
    return fail(ErrorCode::kData,
                "{}: {} samples per pixel asked for, the recording has {}{}: use a smaller --spp "
                "or record more",
                dump, spp, recorded, judge);
  }
  return {};
}

constexpr std::array kResultFiles = {"claims.json",    "dumps.json",  "inputs.json",
                                     "manifest.json",  "results.csv", "results.jsonl",
                                     "statistics.json"};

// Other programs have files of these names, too; an evaluation has its plan or cells beside them,
// also where it was killed.
Result<void> check_own_results(const fs::path& folder) {
  std::error_code status;
  if (CellStore::is_in(folder) || fs::exists(folder / "plan.toml", status)) return {};
  for (const char* name : kResultFiles) {
    if (!fs::exists(folder / name, status)) continue;
    return fail(ErrorCode::kUsage,
                "{}: no evaluation wrote it, no plan.toml is beside it: choose another folder, or "
                "delete it",
                (folder / name).string());
  }
  return {};
}

// What evaluations wrote, and nothing else. Cells go first: a folder without them is not gone on
// with, so that nothing old is taken for new where this is killed. Pictures of `plan`, too: the
// plan that made them may be gone, and they would be shown beside its results.
Result<void> remove_results(const fs::path& folder, const Plan& plan) {
  SPOOL_TRY(check_own_results(folder));
  SPOOL_TRY(CellStore::remove_all(folder));
  std::error_code status;
  for (const char* name : kResultFiles)
    fs::remove(folder / name, status);
  for (const fs::path& shard : shard_manifests(folder))
    fs::remove(shard, status);
  if (const auto earlier = kept_plan(folder))
    EvaluationPictures(folder, earlier->recordings).remove_all(*earlier);
  EvaluationPictures(folder, plan.recordings).remove_all(plan);
  return {};
}

// What --force does: a shard or a merge leaves what others made.
bool starts_anew(const RunRequest& request) {
  return !request.shard && (!request.only || request.only->empty()) && !request.merge;
}

}  // namespace

NamedCells::NamedCells(const Plan& plan) : cells_(plan), order_(cells_.size()) {
  for (std::size_t i = 0; i < cells_.size(); ++i)
    numbers_.push_back(cells_.number(cells_.cell(i)));
  std::iota(order_.begin(), order_.end(), std::size_t{0});
  std::ranges::sort(order_, {}, [this](std::size_t i) { return numbers_[i]; });
}

std::optional<std::size_t> NamedCells::find(const std::string& id) const {
  const auto number = cell_number(id);
  if (!number) return std::nullopt;
  const auto found =
      std::ranges::lower_bound(order_, *number, {}, [this](std::size_t i) { return numbers_[i]; });
  if (found == order_.end() || numbers_[*found] != *number) return std::nullopt;
  return *found;
}

std::optional<std::size_t> NamedCells::twice() const {
  const auto found =
      std::ranges::adjacent_find(order_, {}, [this](std::size_t i) { return numbers_[i]; });
  if (found == order_.end()) return std::nullopt;
  return std::max(*found, *std::next(found));
}

Result<Plan> kept_plan(const fs::path& folder) {
  std::error_code status;
  if (!fs::is_regular_file(folder / "plan.toml", status)) {
    return fail(ErrorCode::kIo,
                "{}: no plan.toml in it: give a folder that spool evaluate -o wrote",
                folder.string());
  }
  return read_plan(folder / "plan.toml", {known_samplers(), known_filters(), true});
}

StudySources study_sources(const CellStore& store, const Plan& plan) {
  return {[&store, cells = PlanCells(plan)](const Cell& cell) {
            return store.read(cell_id(cells.number(cell)), cell);
          },
          [](const std::string& recording) {
            const auto reader = format::SpoolReader::open(recording);
            return reader ? static_cast<double>(reader->header().spp)
                          : std::numeric_limits<double>::quiet_NaN();
          },
          [](const MethodChoice& filter) {
            const Filter* method = find_method(known_filters(), filter.name);
            return method != nullptr && !method->needs.samples && !is_of_replicates(filter);
          }};
}

Result<NamedCells> name_cells(const Plan& plan) {
  if (plan.experiment.order == ReplicateOrder::kRecorded && plan.replicates > 1) {
    return fail(ErrorCode::kUsage,
                "recorded order: {} replicates would be of the same samples: ask for one "
                "(--replicates 1, replicates = 1 in a plan) or leave the order out",
                plan.replicates);
  }
  NamedCells named(plan);
  const std::optional<std::size_t> twice = named.twice();
  if (!twice) {
    if (plan.pictures) SPOOL_TRY(check_picture_names(plan));
    return named;
  }
  const Cell cell = named.cell(*twice);
  return fail(ErrorCode::kUsage, "{} with {} at {} spp is asked for twice: name it once",
              cell.sampler.label(), cell.filter.label(), cell.spp);
}

Result<std::vector<DumpIdentity>> check_dumps(const Plan& plan) {
  for (const std::string& dump : plan.recordings) {
    SPOOL_ASSIGN(const format::SpoolReader reader, format::SpoolReader::open(dump));
    SPOOL_TRY(check_judging(plan, dump, reader));
  }
  for (const PlanScene& scene : scenes_of(plan)) {
    for (const std::string& other : scene.recordings)
      SPOOL_TRY(check_alike(scene, other, plan));
  }
  return identify_dumps(plan.recordings);
}

std::size_t count_others(const CellStore& store, const NamedCells& named) {
  return store.count_others([&](const std::string& id) { return named.find(id).has_value(); });
}

Result<CellStore> prepare_folder(const RunRequest& request, const NamedCells& named, bool force) {
  const fs::path& folder = request.folder;
  std::error_code status;
  const bool empty = !fs::exists(folder, status) || fs::is_empty(folder, status);
  const bool anew = starts_anew(request);
  if (force && anew) {
    SPOOL_TRY(remove_results(folder, request.plan));
  } else if (!empty && !CellStore::is_in(folder)) {
    return fail(ErrorCode::kUsage,
                "{}: exists and holds no results that could be continued: choose another name{}",
                folder.string(), anew ? " or give --force" : "");
  }
  SPOOL_ASSIGN(CellStore store, CellStore::open(folder));
  const std::size_t others = count_others(store, named);
  if (others > 0 && !force) {
    return fail(ErrorCode::kUsage,
                "{}: holds {} results that this plan does not have: choose another folder, or give "
                "--force to {}",
                folder.string(), others, anew ? "start it anew" : "leave them there");
  }
  SPOOL_TRY(CellStore::create(folder));
  sweep(folder, is_part(request) ? kAgeBesideShards : std::chrono::seconds(0));
  return store;
}

Result<void> check_times(const RunRequest& request, const NamedCells& named,
                         const std::vector<bool>& wanted, const CellStore& store) {
  if (!request.exact_timing || request.merge) return {};
  for (std::size_t i = 0; i < named.size(); ++i) {
    if (!wanted[i]) continue;
    const auto record = store.read(named.id(i), named.cell(i));
    if (!record || record->failed() || record->text("timing") != "shared") continue;
    return fail(ErrorCode::kUsage,
                "--timing exact: results in {} were timed beside others: choose another folder{}",
                request.folder.string(),
                starts_anew(request) ? " or give --force to make them anew" : "");
  }
  return {};
}

}  // namespace spool::tools
