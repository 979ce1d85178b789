// The laws that methods are held to, and by name the methods that do not keep one, with the reason.
//
// A method that is not named here keeps every law; one that is named must break it somewhere, so
// that the table cannot go stale (laws_test.cpp).
#pragma once

#include <algorithm>
#include <array>
#include <string_view>

namespace spool::test {

enum class Law {
  kMirror,       // the picture mirrored: the result mirrored
  kTranspose,    // x and y swapped: the result too, angles mapped to 90 - angle
  kPowerOfTwo,   // radiance times 2^k, |k| <= 100 up to the largest sample: the same bits
  kFactor,       // times a factor that floats represent exactly
  kConstant,     // a constant added to every sample
  kChannels,     // channels permuted
  kPrefixOrder,  // the taken samples in another order
  kShift,        // moved by pixels, far from borders (of a torus)
};

struct LawException {
  Law law;
  std::string_view method;
  std::string_view why;
};

inline constexpr std::array kFilterExceptions = {
    LawException{Law::kMirror, "directional robust",
                 "regions R_k are 2^k wide, an even number: they have no middle piece"},
    LawException{Law::kMirror, "directional paper", "regions R_k as above"},
    LawException{Law::kMirror, "multistage",
                 "the windows of its stages, -1..0 and -1..2, are not symmetric"},
    LawException{Law::kMirror, "wavelet_shrinkage", "a decimated transform has a phase"},
    LawException{Law::kPowerOfTwo, "directional paper",
                 "the literal text has a contrast beside squared radiance and no exposure"},
    LawException{Law::kFactor, "directional paper", "no exposure, as above"},
    LawException{Law::kConstant, "directional paper", "contrast is relative to the mean"},
    LawException{Law::kConstant, "twin_guides robust", "compares logarithms"},
    LawException{Law::kConstant, "twin_guides heavy_tails", "compares logarithms"},
    LawException{Law::kChannels, "twin_guides robust", "clamps and limits by luminance"},
    LawException{Law::kChannels, "twin_guides heavy_tails", "clamps and limits by luminance"},
    LawException{Law::kConstant, "welch statmc", "tests square roots of the samples"},
    LawException{Law::kConstant, "welch pooled", "tests fourth roots, too"},
    LawException{Law::kConstant, "stater mcl", "tests fourth roots, too"},
    LawException{Law::kConstant, "stater mc", "tests fourth roots, too"},
    LawException{Law::kConstant, "stater m", "tests fourth roots, too"},
    LawException{Law::kConstant, "nl_means paper",
                 "distances are divided by the variance of few samples plus an epsilon of the "
                 "exposed image"},
    LawException{Law::kChannels, "nl_means paper", "the epsilon, as above"},
    LawException{Law::kConstant, "cross_bilateral cross_nl_means",
                 "tolerances of patches are in units of the exposed image"},
    LawException{Law::kChannels, "cross_bilateral cross_nl_means",
                 "exposure is by luminance, of unequal weights"},
    LawException{Law::kConstant, "clamped", "its limit is a multiple of the neighbours' mean"},
    LawException{Law::kChannels, "directional robust", "decides by luminance, of unequal weights"},
    LawException{Law::kChannels, "directional paper", "decides by luminance"},
    LawException{Law::kChannels, "clamped", "limits the luminance"},
    LawException{Law::kPrefixOrder, "nl_means robust", "compares even samples with odd ones"},
    LawException{Law::kPrefixOrder, "nl_means paper", "compares even samples with odd ones"},
    LawException{Law::kPrefixOrder, "twin_guides robust",
                 "estimates noise from even and odd samples"},
    LawException{Law::kPrefixOrder, "twin_guides heavy_tails",
                 "estimates noise from even and odd samples"},
    LawException{Law::kShift, "twin_guides robust",
                 "its coarsest scale and the means that choose scales reach further than any test "
                 "image is wide"},
    LawException{Law::kShift, "twin_guides heavy_tails",
                 "its coarsest scale and the means that choose scales reach further than any test "
                 "image is wide"},
    LawException{Law::kShift, "wavelet_shrinkage", "a decimated transform has a phase"},
    LawException{Law::kShift, "directional paper",
                 "the sign filters of its bank reach further than any test image is wide"},
};

inline constexpr std::array kSamplerExceptions = {
    LawException{Law::kMirror, "multiscale robust", "regions R_k are 2^k wide"},
    LawException{Law::kMirror, "multiscale paper", "regions R_k are 2^k wide"},
    LawException{Law::kMirror, "mitchell", "what is left of a round goes by row and column"},
    LawException{Law::kMirror, "adaptive_wavelet", "dyadic blocks start at the left and the top"},
    LawException{Law::kMirror, "greedy_error", "draws pixels by their index"},
    LawException{Law::kMirror, "cross_halves", "half a sample a piece is spread by index"},
    LawException{Law::kTranspose, "multiscale robust", "the last region is cut in row order"},
    LawException{Law::kTranspose, "multiscale paper", "the last region is cut in row order"},
    LawException{Law::kTranspose, "mitchell", "what is left of a round goes by row and column"},
    LawException{Law::kTranspose, "adaptive_wavelet", "the last block is cut in row order"},
    LawException{Law::kTranspose, "greedy_error", "draws pixels by their index"},
    LawException{Law::kTranspose, "cross_halves", "half a sample a piece is spread by index"},
    LawException{Law::kPowerOfTwo, "multiscale paper", "no exposure: eq 5 adds unlike units"},
    LawException{Law::kFactor, "multiscale paper", "no exposure: eq 5 adds unlike units"},
    LawException{Law::kConstant, "multiscale robust", "contrast is relative to the mean"},
    LawException{Law::kConstant, "multiscale paper", "contrast is relative to the mean"},
    LawException{Law::kConstant, "mitchell", "contrast is relative to the mean"},
    LawException{Law::kConstant, "adaptive_wavelet", "its error is relative to the mean"},
    LawException{Law::kConstant, "greedy_error", "its error is relative to the mean"},
    LawException{Law::kConstant, "nl_means", "its error is relative to the mean"},
    LawException{Law::kConstant, "filtered_halves", "its error is relative to the mean"},
    LawException{Law::kConstant, "cross_halves", "its error is relative to the mean"},
    LawException{Law::kConstant, "cross_bilateral", "its risk is relative to the mean"},
    LawException{Law::kChannels, "multiscale robust", "decides by luminance, of unequal weights"},
    LawException{Law::kChannels, "multiscale paper", "decides by luminance"},
    LawException{Law::kChannels, "mitchell", "a threshold for each channel"},
    LawException{Law::kChannels, "adaptive_wavelet", "decides by luminance"},
    LawException{Law::kChannels, "greedy_error", "means over channels round in another order"},
    LawException{Law::kChannels, "nl_means", "means over channels round in another order"},
    LawException{Law::kChannels, "filtered_halves", "decides by luminance"},
    LawException{Law::kChannels, "cross_halves", "decides by luminance"},
    LawException{Law::kChannels, "cross_bilateral", "means over channels round in another order"},
};

template <class Table>
constexpr bool keeps(const Table& exceptions, Law law, std::string_view method) {
  return std::none_of(exceptions.begin(), exceptions.end(),
                      [&](const LawException& e) { return e.law == law && e.method == method; });
}

}  // namespace spool::test
