// The method with the smallest mean relMSE so far, of the recording and budget that a result was
// added to last: a line while a user waits.
#pragma once

#include <map>
#include <string>

#include "lib/experiment/experiment.h"

namespace spool::tools {

class BestSoFar {
 public:
  void add(const Cell& cell, double error);  // errors that are not finite are passed over
  std::string describe() const;              // ", best on chess at 8 spp: ..."; empty at first

 private:
  struct Mean {
    double sum = 0;
    int n = 0;
  };
  std::map<std::string, std::map<std::string, Mean>> means_;  // [condition][method]
  std::string condition_;                                     // the last one
};

}  // namespace spool::tools
