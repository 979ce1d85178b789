// What the name of a layer says of it, in the words of renderers and compositing programs.
#pragma once

#include <string>
#include <string_view>

namespace spool {

enum class LayerKind {
  kPicture,   // the whole picture by its name: "", rgba, beauty, Combined
  kNoisy,     // the picture before a denoiser: Noisy Image
  kDenoised,  // the picture after it
  kUnknown,   // a name without a known meaning
  kOther,     // part of a picture, a feature, a statistic, a matte
};

// `pass`: the last component of a layer's name, without a view.
LayerKind layer_kind(std::string_view pass);

// Of a channel that is alone in its layer: a depth, an alpha, a count, an identity.
bool is_no_grey(std::string_view channel);

std::string lower_case(std::string_view text);

}  // namespace spool
