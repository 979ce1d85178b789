// Readings: the defensible ways to understand an equation that a paper's text lacks or misprints,
// by name. They are written behind a preset, NAME:PRESET+READING+READING, and set its options.
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "lib/core/error.h"
#include "lib/core/option_table.h"

namespace spool {

struct Reading {
  std::string name;
  std::string of;  // "eq 7": a choice has at most one reading of each
  std::string summary;
  OptionValues set;
};

// The options that "paper+a+b" sets above its preset, by the readings a and b. Errors kUsage: an
// unknown reading, two of one equation.
Result<OptionValues> reading_values(const std::vector<Reading>& known, std::string_view text);

}  // namespace spool
