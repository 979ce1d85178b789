// How results of a study are named and written in the tables of the terminal and the notes below
// them.
#pragma once

#include <string>
#include <vector>

#include "lib/study/ranked_results.h"

namespace spool::tools {

using ShownResults = std::vector<RankedResult>;

bool is_described_sampler(const RankedResult& result);
bool is_described_filter(const RankedResult& result);

std::string shown_scene(const std::string& recording, const std::string& group);
std::string shown_scene(const StudyPlace& place);       // the group, or the name of the file
std::string shown_sampler(const RankedResult& result);  // with "[R]" where by description
std::string shown_filter(const RankedResult& result);
std::string shown_method(const RankedResult& result);

double mean_or(const Interval& interval, double other);
// "0.0123 [0.011, 0.014]"; "n/a" where not known.
std::string value_text(const Interval& interval, const char* format = "{:.4g}");
// One or two digits less: a ratio is read beside its error. "-" where not known. Neither it nor an
// end reads 1 without being 1.
std::string ratio_text(const Interval& ratio, int digits = 3, int end_digits = 2);

// Two digits of it, as a whole number: 380, not 3.8e+02.
std::string count_text(double count);

}  // namespace spool::tools
