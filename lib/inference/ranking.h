// Which of several methods are separated on one recording and budget: the one verdict that tables,
// sentences, charts and comparisons print.
//
// All pairs are compared together at a family-wise 5 % (Holm), on one scale, by whose means methods
// are listed: logarithms where every value of every compared method is positive, else the values as
// they are. Methods that share a letter are not separated. With more than `most_paired` methods
// only the pairs with the best mean and with the baseline are compared, and there are no letters;
// the family are all pairs, of which any could have been the best's.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "lib/inference/comparison.h"

namespace spool {

struct RankedMethod {
  std::size_t method = 0;  // index into the series
  Interval mean;
  std::string letters;  // empty: not compared, or too many methods
  bool compared = true;
};

struct PairVerdict {
  std::size_t a = 0, b = 0;  // indices into the series; a is the one with the better mean
  Comparison comparison;     // a less b
  Interval ratio;            // a / b where both have logarithms, for itself; else nothing
  double p = 1;              // adjusted; NaN: not compared
  double factor = 1;         // of p, by Holm's rule
  Verdict verdict = Verdict::kUnknown;  // of a against b
};

struct Ranking {
  std::vector<RankedMethod> methods;  // best first; what is not compared is last
  std::vector<PairVerdict> pairs;

  // Of a against b; none where the pair was not compared.
  Verdict between(std::size_t a, std::size_t b) const;
  const PairVerdict* pair(std::size_t a, std::size_t b) const;
};

struct RankOptions {
  Range range = Range::kPositive;
  std::optional<std::size_t> baseline = std::nullopt;
  std::vector<bool> left_out =
      {};  // [method], empty: none: methods that are listed but not compared
  std::size_t most_paired = 128;
  double significance = 0.05;
};

Ranking rank_methods(const std::vector<Series>& methods, Better better,
                     const RankOptions& options = {});

}  // namespace spool
