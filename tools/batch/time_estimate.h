// How long the cells that are left will take, from those that are done.
//
// Sampling is taken as proportional to samples, filtering and judging to pixels, each with a factor
// of the method; a method that was not seen yet takes the mean factor of those that were.
#pragma once

#include <functional>
#include <map>
#include <set>
#include <string>
#include <vector>

#include "lib/experiment/experiment.h"
#include "lib/experiment/result_record.h"

namespace spool::tools {

class TimeEstimate {
 public:
  // All of `cells` are left to do.
  TimeEstimate(const std::vector<Cell>& cells,
               const std::function<double(const std::string& dump)>& pixels);

  // Learns from the times of a result, of a cell that is left or of another one.
  void learn(const Cell& cell, const ResultRecord& record);
  void finished(const Cell& cell);  // is not left any more

  bool known() const { return learnt_ > 0; }
  double seconds_left() const;
  double share_done() const;  // by expected time, 0 .. 1

 private:
  struct Rate {
    double work = 0, seconds = 0;
  };
  using Rates = std::map<std::string, Rate>;

  static double predict(const std::map<std::string, double>& work, const Rates& rates);
  double expected(const std::map<std::string, double>& sampling,
                  const std::map<std::string, double>& filtering, double pixels) const;

  std::map<std::string, double> pixels_of_;                       // by recording
  std::map<std::string, double> sampling_left_, filtering_left_;  // work by label
  std::map<std::string, double> sampling_all_, filtering_all_;
  double pixels_left_ = 0, pixels_all_ = 0;
  Rates sampling_rates_, filtering_rates_;
  Rate rest_;                        // judging and writing
  std::set<std::string> runs_left_;  // sampling runs that no cell has taken off yet
  std::string learnt_run_;           // the sampling run learnt from last
  int learnt_ = 0;
};

}  // namespace spool::tools
