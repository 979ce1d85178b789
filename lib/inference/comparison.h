// Whether one method's error is lower than another's, and what may be said of it.
//
// What lower is better in is compared by its logarithm where all values are positive, so a
// difference is the logarithm of a ratio; else as it is. Ratios that should be 1 are compared by
// |log|. Student's test of the differences of the same replicates, which had the same samples; of
// folders that had not, Welch's [Welch47]. Correlation of replicates widens it as it widens means
// (intervals.h).
#pragma once

#include <limits>
#include <span>
#include <string_view>
#include <vector>

#include "lib/inference/intervals.h"
#include "lib/metrics/error_metrics.h"

namespace spool {

// Whether logarithms are compared: where lower is better, of positive values.
bool compares_logarithms(const Series& a, const Series& b, Better better);

// What is compared: lower is better; as a logarithm where `logarithmic`, of positive values.
double cost(double value, Better better, bool logarithmic);
std::vector<double> costs(const Series& series, Better better, bool logarithmic);

struct Comparison {
  int n = 0;                                                     // pairs of finite values
  double difference = std::numeric_limits<double>::quiet_NaN();  // below 0: the first is better
  double low = std::numeric_limits<double>::quiet_NaN();         // 95 %
  double high = std::numeric_limits<double>::quiet_NaN();
  double p = std::numeric_limits<double>::quiet_NaN();  // two-sided; NaN: cannot be compared
  bool logarithmic = false;           // the exponential of difference, low and high is the ratio
  bool identical = false;             // in every replicate that both have
  Withheld withheld = Withheld::kNo;  // why it is not known

  double standard_error = std::numeric_limits<double>::quiet_NaN();  // of difference
  double freedom = 0;
  double correlation = 0;  // between replicates of the difference

  bool known() const { return p == p; }
  // Two-sided p-value of the difference being `limit`: 1 where it is measured to be so or has no
  // finite error, 0 where it has none at all.
  double p_of(double limit) const;
  // first / second where logarithmic, else nothing.
  Interval ratio() const;
};

// Series of the same replicates, in order. Not known with fewer than two pairs, or where one of
// the two repeats one image while the other varies.
Comparison compare_paired(const Series& a, const Series& b, Better better);
// On a scale that is given; `logarithmic` is of positive values.
Comparison compare_paired(const Series& a, const Series& b, Better better, bool logarithmic);
// Series that have nothing in common.
Comparison compare_independent(const Series& a, const Series& b, Better better);

// About how much more would separate the two at `level` in 80 % of attempts, if they differ by
// what was measured. Replicates help while they bring samples of their own; recordings always do,
// but the third one takes the freedom of halves and replicates away (intervals.h), which counts.
struct MoreNeeded {
  double replicates = 0;  // in all; infinite: no number of this recording
  double recordings = 0;  // in all
};
MoreNeeded more_needed(const Comparison& comparison, int recordings, double level = 0.05);

enum class Verdict {
  kUnknown,    // not compared
  kIdentical,  // the same values in all replicates
  kUndecided,  // not separated
  kBetter,
  kWorse
};
std::string_view verdict_name(Verdict verdict);

// Of the first against the second; `p` adjusted for all comparisons that are made together.
Verdict verdict_of(const Comparison& comparison, double p, double significance = 0.05);

// Adjusted p-values and factors of comparisons that are made together, `p` of each. Methods that
// are identical were not separated by chance and need no protection from it: they keep their p, and
// the others are not charged for them.
struct Family {
  std::vector<double> p, factors;
};
Family family_of(std::span<const Comparison> comparisons, std::span<const double> p,
                 std::size_t family = 0);

// Family-wise p-values by Holm's step-down rule [Holm79], in the order given. NaN stays NaN and is
// no member of the family. `family`: its size where more could have been compared, and what they
// say decided which were; 0: those given.
std::vector<double> holm_adjusted(std::span<const double> p, std::size_t family = 0);
// What each is multiplied by for it, before the product is cut at 1.
std::vector<double> holm_factors(std::span<const double> p, std::size_t family = 0);

}  // namespace spool
