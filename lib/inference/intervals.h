// Mean and 95 % interval of one quantity over replicates, about another recording of the scene.
//
// A quantity whose values are all positive is averaged on its logarithm: the mean is the geometric
// one, the interval is Student's of the logarithms, it stays above zero, and quotients of means are
// means of quotients. Others (a debiased error at or below zero, decibels) are averaged as they
// are.
//
// Replicates that share samples vary less among each other than recordings do. With m values of
// variance s^2 and correlation c between any two, the mean has the variance
//   s^2 / m (1 + (m - 1) c) / (1 - c),
// as E s^2 is only 1 - c of the whole variance; c is `correlation` (shared_samples.h). With c = 0
// this is the usual s^2 / m. Where c is near 1 the replicates hold nothing about the variance h
// between recordings; halves of the recording do (half_spread.h). With f degrees of freedom of h,
// the variance of one replicate is
//   v = (f h + (m - 1) s^2) / (f + (m - 1) (1 - c)),
// and that of the mean v / m (1 + (m - 1) c). v is at least s^2 / (1 - c), with m - 1 degrees of
// freedom: cells do not contain what moves the whole image, such as samples that a bright spot
// takes from all others.
//
// Of kOwnSpread recordings of the scene or more, the means of each recording are values that share
// nothing, and Student's interval of these needs no more.
#pragma once

#include <limits>
#include <span>
#include <vector>

#include "lib/inference/half_spread.h"
#include "lib/inference/shared_samples.h"
#include "lib/inference/withheld.h"

namespace spool {

enum class Range {
  kReal,
  kPositive,  // an error, a time: never below zero
  kShare,     // of a whole: 0 .. 1
};

struct Series {
  // [replicate]; NaN: no result; infinite: a result whose error no number holds, and with it the
  // mean. Without that replicate a method would be judged by those in which it did well.
  std::vector<double> values;
  double correlation = 0;   // of two replicates, 0 .. 1
  TakenSamples taken = {};  // says what two methods have in common; may be left empty
  std::vector<HalfDifference> halves = {};  // of as many splits as were made; empty: not measured
  Withheld withheld = Withheld::kNo;
  int recordings = 1;  // the values are as many of each, one recording after the other

  // Several finite values, all the same: replicates of one image, which do not say how exact it is.
  bool alike() const;
  int known() const;       // finite values
  bool unbounded() const;  // any is infinite
};

inline constexpr int kOwnSpread = 3;  // recordings: with two, one degree of freedom says little

struct Interval {
  int n = 0;  // finite values
  double mean = std::numeric_limits<double>::quiet_NaN();
  double low = std::numeric_limits<double>::quiet_NaN();  // 95 %; NaN when n < 2
  double high = std::numeric_limits<double>::quiet_NaN();
  bool logarithmic = false;  // the mean is geometric
  // Of the mean, of its logarithm where logarithmic; and the degrees of freedom it is known with.
  double standard_error = std::numeric_limits<double>::quiet_NaN();
  double freedom = 0;
};

// Of the finite values. Ends are cut to `range`, which loses nothing that may be true; none where
// the series has its interval withheld.
Interval mean_interval(const Series& series, Range range = Range::kReal);

// Of one value with the standard error that a bootstrap over so many blocks of pixels gives it: as
// large as that of their mean, by Student's with one degree of freedom less.
Interval single_interval(double value, double standard_error, int blocks,
                         Range range = Range::kReal);

// Mean of the means: of logarithms where all of them are (a geometric mean of quantities measured
// independently), else NaN where they mix. The quantities are taken as given, not as drawn
// [Satterthwaite46].
Interval mean_of_intervals(std::span<const Interval> intervals);

// Mean, standard error of the mean and its degrees of freedom, of values as they are. Where one is
// infinite, so is the mean, and nothing else is known.
struct MeanError {
  int n = 0;
  double mean = std::numeric_limits<double>::quiet_NaN();
  double standard_error = std::numeric_limits<double>::quiet_NaN();
  double freedom = 0;
};
MeanError mean_error(std::span<const double> values, double correlation,
                     const HalfSpread& between = {}, int recordings = 1);

bool all_positive(std::span<const double> values);  // and finite, where there is a result

}  // namespace spool
