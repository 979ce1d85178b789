#include "lib/experiment/plan_claims.h"

#include <algorithm>
#include <tuple>

#include <fmt/ranges.h>

#include "lib/core/nearest_name.h"
#include "lib/experiment/result_record.h"

namespace spool {
namespace {

bool has_fresh(const std::string& metric) {
  return metric == "relmse" || metric == "mse" || metric == "energy_ratio";
}

Result<void> set_claim(const TomlReader& toml, Claim& claim, std::string_view key,
                       const toml::node& value, const Plan& plan) {
  if (key == "threads" || key == "than_threads") {
    SPOOL_ASSIGN(const std::string text, toml.text_of(value));
    SPOOL_ASSIGN(const int threads, toml.at(value, parse_integer(std::string(key), text, 1, 1024)));
    if (std::ranges::find(plan.threads, threads) == plan.threads.end())
      return toml.refuse(value, "threads {} is no number of threads of the plan", text);
    (key == "threads" ? claim.threads : claim.than_threads) = threads;
    return {};
  }
  if (key == "spp") {
    for (const toml::node* budget : values_of(value)) {
      SPOOL_ASSIGN(const std::string text, toml.text_of(*budget));
      SPOOL_ASSIGN(const double spp, toml.at(*budget, parse_number("spp", text, 1e-3, 65536.0)));
      if (std::ranges::find(plan.spp, spp) == plan.spp.end()) {
        return toml.refuse(*budget, "spp {} is no budget of the plan", text);
      }
      if (std::ranges::find(claim.spp, spp) != claim.spp.end())
        return toml.refuse(*budget, "spp {} is there twice", text);
      claim.spp.push_back(spp);
    }
    return {};
  }
  SPOOL_ASSIGN(const std::string text, toml.text_of(value));
  if (key == "text") {
    claim.text = text;
  } else if (key == "source") {
    claim.source = text;
  } else if (key == "better" || key == "than") {
    SPOOL_TRY(toml.at(value, check_method_name(plan, text)));
    (key == "better" ? claim.better : claim.than) = text;
  } else if (key == "metric") {
    const std::vector<std::string> known = claimed_metrics();
    if (std::ranges::find(known, text) == known.end())
      return toml.refuse(value, "{}",
                         unknown_name("metric of a claim", text, known,
                                      fmt::format(": one of {}", fmt::join(known, ", "))));
    claim.metric = text;
  } else if (key == "samples") {
    if (text != "own" && text != "fresh")
      return toml.refuse(value, "samples is own or fresh, not '{}'", text);
    claim.fresh = text == "fresh";
  } else if (key == "below") {
    SPOOL_ASSIGN(claim.below, toml.at(value, parse_number("below", text, 1e-6, 1e6)));
  } else {
    return toml.refuse(value, "{}",
                       unknown_name("key of a claim", key,
                                    {"text", "better", "than", "metric", "spp", "samples", "below",
                                     "source", "threads", "than_threads"}));
  }
  return {};
}

// Whether both ask one question of one budget, whatever their words: their family would be charged
// for it twice.
bool is_asked_again(const Claim& claim, const Claim& other, const std::vector<double>& budgets) {
  const auto question = [](const Claim& of) {
    return std::tie(of.better, of.than, of.metric, of.fresh, of.below, of.threads, of.than_threads);
  };
  return question(claim) == question(other) && std::ranges::any_of(budgets, [&](double spp) {
           return claim.asks(spp, claim.threads) && other.asks(spp, other.threads);
         });
}

std::string text_of(const Claim& claim) {
  if (claim.below == 1.0) return claim.better + " has less error than " + claim.than;
  return fmt::format("{} has less than {:g} times the error of {}", claim.better, claim.below,
                     claim.than);
}

}  // namespace

Result<void> read_claims(const TomlReader& toml, const toml::table& root, Plan& plan) {
  const toml::node* tables = root.get("claim");
  if (!tables) return {};
  for (const toml::node* node : values_of(*tables)) {
    const toml::table* table = node->as_table();
    if (!table)
      return toml.refuse(*node, "write [[claim]] and below it better = ... and than = ...");
    Claim claim;
    for (const auto& [key, value] : *table)
      SPOOL_TRY(set_claim(toml, claim, key.str(), value, plan));
    if ((claim.threads == 0) != (claim.than_threads == 0)) {
      return toml.refuse(*table, "threads and than_threads: give both, or none");
    }
    if (claim.better.empty() || claim.than.empty() ||
        (claim.better == claim.than && claim.threads == claim.than_threads)) {
      return toml.refuse(*table,
                         "a claim needs two methods: better = \"SAMPLER + FILTER\" and than");
    }
    if (claim.fresh && !has_fresh(claim.metric)) {
      return toml.refuse(*table, "samples = \"fresh\": only of relmse, mse and energy_ratio");
    }
    if (std::ranges::any_of(plan.claims, [&](const Claim& other) {
          return is_asked_again(claim, other, plan.spp);
        })) {
      return toml.refuse(*table, "this claim is there twice: ask it once");
    }
    if (claim.text.empty()) claim.text = text_of(claim);
    plan.experiment.fresh = plan.experiment.fresh || claim.fresh;
    plan.claims.push_back(std::move(claim));
  }
  return {};
}

}  // namespace spool
