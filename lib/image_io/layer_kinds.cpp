#include "lib/image_io/layer_kinds.h"

#include <algorithm>
#include <array>
#include <vector>

namespace spool {
namespace {

using Word = std::string_view;

// The whole name, without what separates words.
constexpr std::array<Word, 13> kPictures = {
    "",       "rgba", "rgb", "beauty", "masterbeauty", "combined", "color",
    "colour", "ci",   "c",   "image",  "main",         "radiance"};

// Anywhere in the name.
constexpr std::array<Word, 7> kNoisy = {"noisy",     "undenois",     "nodenois",      "notdenois",
                                        "predenois", "beforedenois", "denoisingimage"};
constexpr std::array<Word, 50> kOther = {
    "albedo",      "normal",       "position",      "depth",       "motion",     "velocity",
    "crypto",      "variance",     "stddev",        "stdev",       "deviation",  "occlusion",
    "shadow",      "alpha",        "opacity",       "coverage",    "matte",      "mask",
    "samplecount", "numsamples",   "sampledensity", "objectid",    "materialid", "diffcol",
    "glosscol",    "transcol",     "subsurfacecol", "reflectance", "roughness",  "basecolor",
    "diffuse",     "specular",     "glossy",        "indirect",    "emission",   "emissive",
    "subsurface",  "transmission", "reflection",    "refraction",  "background", "environment",
    "volumetric",  "texcoord",     "disparity",     "tangent",     "confidence", "heatmap",
    "reference",   "geometric"};
constexpr std::array<Word, 2> kDenoised = {"denois", "effectsresult"};

// One word of the name.
constexpr std::array<Word, 5> kDenoisedWords = {"oidn", "optix", "nlm", "filtered", "odn"};
constexpr std::array<Word, 48> kOtherWords = {
    "n",         "ns",      "ng",       "p",        "pos",      "pref",     "z",        "uv",
    "st",        "id",      "ids",      "index",    "ao",       "mist",     "mv",       "vector",
    "var",       "mse",     "error",    "count",    "counts",   "samples",  "spp",      "weight",
    "weights",   "time",    "direct",   "emit",     "env",      "sss",      "coat",     "sheen",
    "volume",    "diffdir", "diffind",  "glossdir", "glossind", "transdir", "transind", "volumedir",
    "volumeind", "gi",      "caustics", "noise",    "forward",  "indexob",  "indexma",  "ref"};

constexpr std::array<Word, 4> kGreyless = {"a", "n", "x", "z"};

bool is_letter_or_digit(char c) {
  return (c >= 'a' && c <= 'z') || (c >= '0' && c <= '9') || static_cast<unsigned char>(c) >= 0x80;
}

// Also without "normalized", which is of no normals.
std::string squashed(const std::string& name) {
  std::string text;
  std::copy_if(name.begin(), name.end(), std::back_inserter(text), is_letter_or_digit);
  for (const Word scaled : {"normalized", "normalised"})
    if (const std::size_t at = text.find(scaled); at != std::string::npos)
      text.erase(at, scaled.size());
  return text;
}

std::vector<std::string> words_of(const std::string& name) {
  std::vector<std::string> words(1);
  for (const char c : name) {
    if (is_letter_or_digit(c)) {
      words.back() += c;
    } else if (!words.back().empty()) {
      words.emplace_back();
    }
  }
  return words;
}

template <std::size_t N>
bool has_any(const std::string& text, const std::array<Word, N>& stems) {
  return std::any_of(stems.begin(), stems.end(),
                     [&](Word stem) { return text.find(stem) != std::string::npos; });
}

template <std::size_t N>
bool is_any(std::string_view word, const std::array<Word, N>& known) {
  return std::find(known.begin(), known.end(), word) != known.end();
}

template <std::size_t N>
bool has_word(const std::vector<std::string>& words, const std::array<Word, N>& known) {
  return std::any_of(words.begin(), words.end(),
                     [&](const std::string& word) { return is_any(word, known); });
}

}  // namespace

std::string lower_case(std::string_view text) {
  std::string lower(text);
  std::transform(lower.begin(), lower.end(), lower.begin(),
                 [](char c) { return c >= 'A' && c <= 'Z' ? static_cast<char>(c + 32) : c; });
  return lower;
}

LayerKind layer_kind(std::string_view pass) {
  const std::string name = lower_case(pass), text = squashed(name);
  const std::vector<std::string> words = words_of(name);
  if (is_any(text, kPictures)) return LayerKind::kPicture;
  if (has_any(text, kOther) || has_word(words, kOtherWords)) return LayerKind::kOther;
  if (has_any(text, kNoisy) || text.ends_with("unfiltered")) return LayerKind::kNoisy;
  if (has_any(text, kDenoised) || has_word(words, kDenoisedWords)) return LayerKind::kDenoised;
  return LayerKind::kUnknown;
}

bool is_no_grey(std::string_view channel) {
  const std::string name = lower_case(channel);
  return is_any(name, kGreyless) || layer_kind(name) == LayerKind::kOther;
}

}  // namespace spool
