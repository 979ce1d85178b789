#include "tools/json/study_json.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <ostream>

#include <nlohmann/json.hpp>

#include "formats/bounded_json.h"
#include "lib/image_io/atomic_file.h"
#include "tools/json/json_text.h"
#include "tools/methods/external_methods.h"

namespace spool::tools {
namespace {

using nlohmann::ordered_json;

constexpr const char* kClaims = "claims.json";

const char* const kRules[][2] = {
    {"mean",
     "Over the replicates; of errors and times geometric where every value is positive, so that "
     "quotients of means are means of quotients. None where a value is infinite."},
    {"interval",
     "An interval at 95 % says where the mean of another recording of the scene would lie; each "
     "is computed for itself. It is Student's, of the logarithms where the mean is geometric, and "
     "wider where replicates share samples. The reference is taken as given."},
    {"order",
     "`order_low` and `order_high`, where given, are about this recording in another order of its "
     "samples, and about nothing else."},
    {"verdict",
     "Methods are compared replicate by replicate on the logarithms of their errors, or, where an "
     "error of one of them is not positive, on all errors as they are; they are listed by the "
     "means on that scale. Verdicts are Holm's, at 5 % for all pairs of a scene, budget and metric "
     "together, but for identical methods. Methods that share a letter are not separated."},
    {"claim",
     "A question of the plan: the ratio of two errors lies below its limit. The claims of a scene "
     "and budget together at 5 % (Holm), apart from the pairs. Over several places: holds where "
     "some hold and none is reversed."},
    {"ratio", "To the baseline at the same budget, with its interval for itself."},
    {"withheld",
     "Neither interval nor verdict: fewer than 3 pixels bear half of the error, those of "
     "independent replicates together (20 where halves are not measured; any number with three "
     "recordings), or, for relMSE, the relative variance of the reference is above 0.01."},
    {"would_decide",
     "Where a method and the baseline are not separated: about how many replicates, or recordings "
     "where replicates would repeat their samples, separate a difference as measured in 80 % of "
     "attempts, by itself."},
    {"equal_time",
     "The error in the processor time of the baseline (sampling, filtering and, where recorded, "
     "rendering), read from the method's own budgets and never beyond them."},
    {"energy", "Methods whose energy ratio is below 0.98, beyond its interval, lose energy."}};

// [mean, low, high], [mean], or nothing.
ordered_json interval_json(const Interval& interval) {
  ordered_json list = ordered_json::array();
  if (!std::isfinite(interval.mean)) return list;
  list.push_back(interval.mean);
  if (std::isfinite(interval.low) && std::isfinite(interval.high)) {
    list.push_back(interval.low);
    list.push_back(interval.high);
  }
  return list;
}

ordered_json place_json(const StudyPlace& place) {
  return {{"dump", place.recording}, {"spp", place.spp}, {"threads", place.threads}};
}

void add_methods(ordered_json& entry, const MethodPair& methods) {
  entry["sampler"] = methods.sampler;
  entry["filter"] = methods.filter;
}

void add_quantities(ordered_json& entry, const std::vector<Interval>& found) {
  for (std::size_t q = 0; q < found.size(); ++q) {
    if (std::isfinite(found[q].mean))
      entry["quantities"][quantities()[q].name] = interval_json(found[q]);
  }
}

ordered_json result_json(const MethodFinding& result) {
  ordered_json entry = place_json(result.place);
  add_methods(entry, result.methods);
  entry["sampler_name"] = result.sampler_name;
  entry["filter_name"] = result.filter_name;
  entry["replicates"] = result.replicates;
  entry["failed"] = result.failed;
  entry["one_image"] = result.one_image;
  entry["shared"] = result.shared;
  entry["correlation"] = result.correlation;
  entry["reference"] = result.reference;
  add_quantities(entry, result.quantities);
  return entry;
}

ordered_json would_decide_json(const WouldDecide& more) {
  return {{more.unit(), more.count}};
}

ordered_json ranked_json(const Study& study, const RankedFinding& ranked) {
  ordered_json entry;
  add_methods(entry, study.results[ranked.result].methods);
  entry["value"] = interval_json(ranked.value);
  if (ranked.order) {
    entry["order_low"] = json_number(ranked.order->low);
    entry["order_high"] = json_number(ranked.order->high);
  }
  entry["letters"] = ranked.letters;
  entry["compared"] = ranked.compared;
  if (ranked.withheld != Withheld::kNo) entry["withheld"] = withheld_name(ranked.withheld);
  if (ranked.against_best) entry["against_best"] = verdict_name(*ranked.against_best);
  if (ranked.p_against_best) entry["p_against_best"] = json_number(*ranked.p_against_best);
  if (ranked.against_baseline) entry["against_baseline"] = verdict_name(*ranked.against_baseline);
  if (ranked.ratio) entry["ratio"] = interval_json(*ranked.ratio);
  if (ranked.baseline_withheld != Withheld::kNo)
    entry["baseline_withheld"] = withheld_name(ranked.baseline_withheld);
  if (ranked.would_decide) entry["would_decide"] = would_decide_json(*ranked.would_decide);
  entry["energy"] = interval_json(ranked.energy);
  if (ranked.loses_energy) entry["loses_energy"] = *ranked.loses_energy;
  return entry;
}

ordered_json about_json(const About& about) {
  return {{"kind", about.kind}, {"shared", about.shared}, {"text", about.text}};
}

ordered_json condition_json(const Study& study, const ConditionFinding& condition) {
  ordered_json entry = place_json(condition.place);
  entry["metric"] = condition.metric;
  entry["biased"] = condition.biased;
  entry["about"] = about_json(condition.about);
  entry["ranking"] = ordered_json::array();
  for (const RankedFinding& ranked : condition.ranking)
    entry["ranking"].push_back(ranked_json(study, ranked));
  if (!condition.pairs) return entry;
  entry["pairs"] = ordered_json::array();
  for (const PairFinding& pair : *condition.pairs)
    entry["pairs"].push_back({pair.first, pair.second, json_number(pair.ratio.mean),
                              json_number(pair.ratio.low), json_number(pair.ratio.high),
                              json_number(pair.p), verdict_name(pair.verdict)});
  return entry;
}

ordered_json needed_json(const NeededAt& found) {
  const SamplesNeeded& needed = found.needed;
  return {{"at", found.at},
          {"spp", needed.spp},
          {"low", json_number(needed.low)},
          {"high", json_number(needed.high)},
          {"bound", needed.at_most ? "at most" : (needed.more_than ? "more than" : "")}};
}

ordered_json equal_time_json(const EqualTimeAt& at) {
  ordered_json entry = {{"at", at.at}, {"seconds", json_number(at.seconds)}};
  if (at.found.too_slow || at.found.too_fast) {
    entry["outside"] = at.found.too_slow ? "too slow" : "too fast";
  } else {
    entry["ratio"] = interval_json(at.found.ratio);
  }
  return entry;
}

ordered_json curve_json(const CurveFinding& curve) {
  ordered_json entry = {{"dump", curve.recording}, {"threads", curve.threads}};
  add_methods(entry, curve.methods);
  entry["biased"] = curve.biased;
  entry["metric"] = curve.metric;
  entry["budgets"] = curve.budgets;
  entry["slope"] = interval_json(curve.slope);
  if (!curve.against_baseline) return entry;
  entry["needed"] = ordered_json::array();
  for (const NeededAt& needed : curve.needed)
    entry["needed"].push_back(needed_json(needed));
  entry["equal_time"] = ordered_json::array();
  for (const EqualTimeAt& at : curve.equal_time)
    entry["equal_time"].push_back(equal_time_json(at));
  return entry;
}

ordered_json overall_json(const OverallFinding& overall) {
  ordered_json entry = {{"spp", overall.spp}, {"threads", overall.threads}};
  add_methods(entry, overall.methods);
  add_quantities(entry, overall.quantities);
  for (const auto& [metric, against] : overall.against) {
    entry["against_baseline"][metric] = {{"ratio", interval_json(against.ratio)},
                                         {"better", against.better},
                                         {"worse", against.worse},
                                         {"undecided", against.undecided}};
  }
  return entry;
}

ordered_json claim_place_json(const ClaimFinding::At& at, bool fresh) {
  const Comparison& comparison = at.judged.comparison;
  ordered_json entry = place_json(at.place);
  entry["verdict"] = claim_verdict_name(at.judged.verdict);
  entry["ratio"] = interval_json(comparison.ratio());
  entry["p"] = json_number(at.judged.p);
  entry["replicates"] = comparison.n;
  entry["biased"] = at.biased;
  if (!comparison.logarithmic && comparison.known())
    entry["difference"] = {comparison.difference, comparison.low, comparison.high};
  if (comparison.withheld != Withheld::kNo) entry["withheld"] = withheld_name(comparison.withheld);
  if (fresh) entry["samples"] = "fresh";
  return entry;
}

ordered_json question_json(const Claim& claim) {
  ordered_json question = {{"text", claim.text},
                           {"better", claim.better},
                           {"than", claim.than},
                           {"metric", claim.metric},
                           {"samples", claim.fresh ? "fresh" : "own"},
                           {"below", claim.below}};
  if (claim.threads > 0) question["threads"] = {claim.threads, claim.than_threads};
  return question;
}

ordered_json claim_json(const ClaimFinding& finding) {
  ordered_json entry = question_json(finding.claim);
  std::map<std::string, int> counts;
  ordered_json places = ordered_json::array();
  for (const ClaimFinding::At& at : finding.places) {
    ++counts[std::string(claim_verdict_name(at.judged.verdict))];
    places.push_back(claim_place_json(at, finding.claim.fresh));
  }
  entry["verdict"] = claim_verdict_name(finding.verdict);
  entry["counts"] = counts;
  entry["places"] = std::move(places);
  if (!finding.claim.spp.empty()) entry["spp"] = finding.claim.spp;
  if (!finding.claim.source.empty()) entry["source"] = finding.claim.source;
  if (finding.after_results) entry["after_results"] = true;
  return entry;
}

// The ranks of a result by one metric.
ordered_json ranks_json(const RankedFinding& ranked) {
  ordered_json entry = {{"letters", ranked.letters}};
  if (ranked.ratio) entry["ratio"] = interval_json(*ranked.ratio);
  if (ranked.against_baseline) entry["against_baseline"] = verdict_name(*ranked.against_baseline);
  if (ranked.against_best) entry["against_best"] = verdict_name(*ranked.against_best);
  if (ranked.would_decide) entry["would_decide"] = would_decide_json(*ranked.would_decide);
  if (ranked.withheld != Withheld::kNo) entry["withheld"] = withheld_name(ranked.withheld);
  if (ranked.baseline_withheld != Withheld::kNo)
    entry["baseline_withheld"] = withheld_name(ranked.baseline_withheld);
  return entry;
}

std::string dense_text(const ordered_json& value, int indent) {
  return value.dump(indent, ' ', false, ordered_json::error_handler_t::replace);
}

// As it stands inside a larger value, `depth` spaces from the left.
std::string indented(const ordered_json& value, int depth) {
  std::string text;
  for (const char c : dense_text(value, 1)) {
    text += c;
    if (c == '\n') text.append(static_cast<std::size_t>(depth), ' ');
  }
  return text;
}

// What a claim asks, as claims.json holds it.
std::string question_of(const Claim& claim) {
  ordered_json question = question_json(claim);
  if (!claim.spp.empty()) question["spp"] = claim.spp;
  return dense_text(question, -1);
}

}  // namespace

void write_statistics(std::ostream& out, const Study& study) {
  ordered_json rules;
  for (const auto& [name, text] : kRules)
    rules[name] = text;
  out << "{\n \"version\": 1,\n \"rules\": " << indented(rules, 1);
  // A finding at a time: all of them as one value take fifty times the memory of their text.
  const auto fill = [&](const char* name, const auto& findings, const auto& as_json) {
    out << ",\n \"" << name << "\": [";
    bool first = true;
    for (const auto& finding : findings) {
      out << (first ? "\n  " : ",\n  ") << indented(as_json(finding), 2);
      first = false;
    }
    out << (first ? "]" : "\n ]");
  };
  fill("scenes", study.scenes, [](const PlanScene& scene) {
    return ordered_json{{"dump", scene.recordings.front()},
                        {"group", scene.group},
                        {"recordings", scene.recordings}};
  });
  fill("claims", study.claims, claim_json);
  fill("results", study.results, result_json);
  fill("conditions", study.conditions,
       [&](const ConditionFinding& condition) { return condition_json(study, condition); });
  fill("curves", study.curves, curve_json);
  fill("overall", study.overall, overall_json);
  out << ",\n \"baseline\": " << indented(study.baseline, 1) << "\n}\n";
}

std::string study_text(const Study& study) {
  ordered_json shown = {{"baseline", study.baseline}};
  for (const char* list : {"claims", "about", "results"})
    shown[list] = ordered_json::array();
  for (const ClaimFinding& claim : study.claims)
    shown["claims"].push_back(claim_json(claim));
  for (const ConditionFinding& condition : study.conditions) {
    if (!condition.pairs) continue;
    shown["about"].push_back(place_json(condition.place));
    shown["about"].back()["metric"] = condition.metric;
    shown["about"].back().update(about_json(condition.about));
  }
  for (const RankedResult& ranked : ranked_results(study)) {
    const MethodFinding& result = *ranked.result;
    ordered_json entry = result_json(result);
    entry["sampler_by_description"] = is_by_description(known_samplers(), result.sampler_name);
    entry["filter_by_description"] = is_by_description(known_filters(), result.filter_name);
    entry["biased"] = result.reference.ends_with("(biased)");
    if (ranked.relmse) entry["ranks"]["relmse"] = ranks_json(*ranked.relmse);
    if (ranked.mse) entry["ranks"]["mse"] = ranks_json(*ranked.mse);
    shown["results"].push_back(std::move(entry));
  }
  return json_text(shown);
}

std::vector<KeptClaim> kept_claims(const std::filesystem::path& statistics_file) {
  const auto json = format::parse_json_file<ordered_json>(statistics_file);
  if (!json.is_object() || !json.contains("claims") || !json["claims"].is_array()) return {};
  std::vector<KeptClaim> claims;
  for (const ordered_json& claim : json["claims"]) {
    const auto text_of = [&](const char* key) {
      const bool known = claim.is_object() && claim.contains(key) && claim[key].is_string();
      return known ? claim[key].get<std::string>() : std::string();
    };
    claims.push_back({text_of("text"), text_of("verdict")});
  }
  return claims;
}

Result<void> register_claims(const std::filesystem::path& folder, const Plan& plan) {
  ordered_json questions = ordered_json::array();
  for (const Claim& claim : plan.claims)
    questions.push_back(question_of(claim));
  return write_text_file(folder / kClaims, questions.dump(1) + "\n", true, true);
}

void mark_late_claims(const std::filesystem::path& folder, std::vector<ClaimFinding>& claims) {
  const auto kept = format::parse_json_file<ordered_json>(folder / kClaims);
  for (ClaimFinding& finding : claims) {
    const ordered_json question = question_of(finding.claim);
    finding.after_results =
        !kept.is_array() || std::find(kept.begin(), kept.end(), question) == kept.end();
  }
}

}  // namespace spool::tools
