// Images of an evaluation that pass through another program: the filter
// image:DIR/{recording}_{spp}_{replicate}.exr, one file for each result.
//
// {recording} is the name of its file without ending, {sampler} its label, both with '_' for what a
// file name should not hold; {spp} the budget; {replicate} a number, and with a letter after it an
// image of a half: 0a and 0b of the two halves by which the spread is measured, 0c and 0d of the
// same halves with the counts of the other (lib/experiment/fresh_samples.h).
#pragma once

#include <string>

#include "lib/experiment/cell.h"
#include "lib/filters/filter.h"
#include "lib/image_io/foreign_picture.h"
#include "lib/image_io/layer_choice.h"

namespace spool::tools {

// Of a picture that is laid beside the samples.
NeededSize size_of(const SamplePool& pool);

// A filter whose file name holds one of the names in braces.
bool is_of_replicates(const MethodChoice& filter);

// A label or the name of a recording as part of a file name; a long one is cut, with a checksum of
// the whole at its end.
std::string file_name_of(const std::string& label);

// `pattern` with what is known of the cell filled in, all but {replicate}.
std::string fill_names(std::string pattern, const Cell& cell);
// The same with the replicate, "0" or "0a".
std::string fill_replicate(std::string pattern, const std::string& replicate);

// All names of the pattern filled in.
std::string image_of(const Cell& cell, const std::string& pattern);

// The cell with its filter's file names filled in, for make_method.
Cell with_filled_names(const Cell& cell);

// Which image of a replicate the next call of a filter is about: "" of the whole pool, then a, b,
// c, d of its halves, in the order in which an experiment asks for them. Of one cell.
class ImageLetters {
 public:
  std::string next(const SamplePool& pool);

 private:
  char letter_ = 'a';
};

// The filter that reads the images. kIo names a file that is missing. `replicate` empty: known to
// no experiment, so that every call is an error.
ReadyFilter replicate_image_filter(const std::string& pattern, const std::string& replicate,
                                   const LayerChoice& layer);

}  // namespace spool::tools
