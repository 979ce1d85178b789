// The table that `spool evaluate` prints: means over replicates, and ratios to uniform with box.
#pragma once

#include <cstddef>
#include <map>
#include <string>
#include <vector>

#include "lib/experiment/experiment.h"
#include "lib/experiment/result_record.h"

namespace spool::tools {

class EvaluationSummary {
 public:
  // Results in any order; failed ones are passed over.
  void add(const Cell& cell, const ResultRecord& record);

  // One line per recording, budget, sampler, filter and number of threads. Mean +- standard error
  // over the replicates. Where there are very many, the best of each recording and budget.
  std::string text() const;
  std::string json() const;  // the same as a list of objects, always whole

 private:
  // The replicates of one combination.
  struct Group {
    Cell cell;
    std::string reference;
    std::vector<double> mse, relmse, energy, sampling, filtering, spent;
  };

  std::vector<const Group*> sorted() const;  // by recording and budget
  const Group* baseline_of(const Group& group) const;
  static std::string condition_key(const Cell& cell);

  std::vector<Group> groups_;
  std::map<std::string, std::size_t> index_;       // of a group, by its key
  std::map<std::string, std::size_t> baselines_;   // by recording, budget, threads
  std::map<std::string, std::size_t> conditions_;  // rank of its first appearance
};

}  // namespace spool::tools
