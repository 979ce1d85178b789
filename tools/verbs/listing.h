// What `spool list` lists, as the library knows it.
#pragma once

#include <string>
#include <utility>
#include <vector>

#include "lib/methods/reading.h"

namespace spool::tools {

struct ListedOption {
  std::string name, allowed, help;
  bool expert = false;
  bool of_every = false;                                      // every filter has it
  std::vector<std::pair<std::string, std::string>> defaults;  // by preset; "default" without any
};

// A sampler, a filter, or a format of another program, which has name, summary and options alone.
struct ListedMethod {
  std::string name, summary;
  std::vector<ListedOption> options;
  std::string argument = {};
  bool by_description = false;
  std::vector<std::string> needs = {};  // in words
  bool footprints = false;
  std::vector<std::string> presets = {};
  std::vector<Reading> readings = {};
};
using ListedMethods = std::vector<ListedMethod>;

ListedMethods listed_samplers();
ListedMethods listed_filters();
std::vector<ListedOption> options_of_every_filter();
std::vector<ListedOption> options_of_the_pool();
std::vector<ListedOption> options_of_metrics();
ListedMethods listed_imports();
ListedMethods listed_exports();

// The methods that have a preset of the name.
struct ListedPreset {
  std::string name;
  std::vector<std::string> samplers, filters;
};
std::vector<ListedPreset> listed_presets();

// Rows of text under the names of their columns.
struct ListedTable {
  std::vector<std::string> columns;
  std::vector<std::vector<std::string>> rows;
};
ListedTable listed_metrics();
ListedTable listed_columns();  // of results.csv
ListedTable listed_views();
ListedTable listed_scenes();
ListedTable listed_scene_options();

// Every list by its name, with the names in it.
using ListedNames = std::vector<std::pair<std::string, std::vector<std::string>>>;
ListedNames listed_names();

}  // namespace spool::tools
