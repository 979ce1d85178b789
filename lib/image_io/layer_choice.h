// Which layer of a file is the picture: the one rule of every door that reads a foreign picture.
//
// By its name (layer_kinds.h), never by its place in the alphabet: a layer that is called a picture
// goes before one of an unknown name; where two are left, both are named and nothing is chosen.
// Features, parts of a picture, mattes and counts are taken only where the user names them.
#pragma once

#include <string>
#include <vector>

#include "lib/core/error.h"
#include "lib/image_io/exr_layers.h"
#include "lib/image_io/exr_source.h"

namespace spool {

struct LayerChoice {
  std::string layer, part;  // as the user named them; empty: the rule's
  // How a user names them, for messages; empty where a door has no option for it.
  std::string layer_option = "--layer ", part_option = "--part ";
};

// Of a door that has no option for it.
inline const LayerChoice kNoLayerOption = {"", "", "", ""};

enum class Taken {
  kPicture,  // of a picture and its denoised version the one that the file calls the picture
  kSamples,  // the noisy one: a denoised picture is no sample
};

struct ChosenLayer {
  ExrLayer layer;
  std::string remark;  // about the choice, where there is something to say; else empty
};

// kData where no layer or several could be meant, kUsage for a name that is not there.
Result<ChosenLayer> choose_layer(const std::string& file, const std::vector<ExrPart>& parts,
                                 const std::vector<ExrLayer>& layers, const LayerChoice& choice,
                                 Taken taken);

}  // namespace spool
