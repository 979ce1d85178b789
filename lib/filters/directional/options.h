// All options of the directional reconstruction and its two presets.
//
//   robust (default)  what recorded pools taught: a base image that can be refused, sizes that only
//                     open unless the evidence is strong, directions of gradients, piece weights
//   paper             the most literal reading of the text that can be defended
// Nothing in the code asks for a preset's name; docs/method.md says what each symbol means.
#pragma once

#include "lib/core/option_table.h"
#include "lib/directions/directional_energy.h"
#include "lib/directions/directional_filter_bank.h"
#include "lib/methods/reading.h"
#include "lib/pyramid/laplacian_pyramid.h"
#include "lib/statistics/contrast.h"
#include "lib/statistics/variance_of_mean.h"

namespace spool {

// S_k of eq 9.
enum class SizeVariance {
  kCoarseVariance,  // variance of the mean over R_k
  kContrast,        // V_k of eq 6, as the text says
};
// q_k of eq 9.
enum class SizeCoarse {
  kBox,      // mean over R_k
  kPyramid,  // f_k of the pyramid
};
// w_k of eq 9.
enum class SizeFactorRule {
  kConstant,        // `constant`
  kLiteral,         // |A_k - A_{k+1}| / (A_k + A_{k+1})
  kLiteralClamped,  // the same, clamped to [0.05, 0.30]
  kInverse,         // (A_k + A_{k+1}) / |A_k - A_{k+1}|, at most 1e6
  kGreedy,          // beta_k z of the greedy selection: beta_0 = 1, beta_k = 5/3
};
struct SizeFactor {
  SizeFactorRule rule = SizeFactorRule::kConstant;
  double constant = 0.5;
  friend bool operator==(const SizeFactor&, const SizeFactor&) = default;
};
enum class SizeSmooth {
  kOpensOnly,  // stop where the piece and its neighbours' vote, without its own, both say so
  kOn,         // stop where the vote of the neighbourhood, its own included, says so
  kOff,
};

// What eq 9 looks at.
enum class SizeChannels {
  kOfSelection,  // the signal that the sampler decided by; luminance of a bare selection
  kLuminance,
  kMaxRgb,
  kPerChannel,  // T = mean of T over red, green and blue
};

struct FilterSizeOptions {
  SizeChannels channels = SizeChannels::kOfSelection;
  SizeVariance variance = SizeVariance::kCoarseVariance;
  ContrastForm contrast = ContrastForm::kGuarded;
  SizeCoarse coarse = SizeCoarse::kBox;
  SizeFactor factor;
  double factor_fallback = 0.10;  // where A_k + A_{k+1} = 0 or both were never updated
  bool track_a0 = false;          // A_0 as the sampler kept it; else A_0 := A_1
  SizeSmooth smooth = SizeSmooth::kOpensOnly;
  double evidence = 3.0;  // standard deviations of a difference that no vote overrules; 0: none
  // So many levels above the least that eq 9 chose for its 8 neighbours is the most; 0: any. Their
  // choices are not limited first, so that in the end two neighbours may differ by more.
  int step = 0;
  bool lone = false;  // sizes smaller than those around them stay (lone_sizes.h)
};

enum class AnisotropySource {
  kFilterBank,       // energies of the directional filter bank
  kNone,             // no direction: round filters
  kStructureTensor,  // energies of the smoothed gradient tensor
};
enum class FilterAngle {
  kTangent,  // beta = wedge frequency angle + 90: along edges
  kNormal,   // beta = wedge frequency angle: across them (demonstration)
};
struct FilterWidthOptions {
  AnisotropySource anisotropy = AnisotropySource::kStructureTensor;
  FilterAngle angle = FilterAngle::kTangent;
  double sigma_max = 0.40;  // widest standard deviation / 2^k
  double rho = 0.10;        // narrowest / widest
  double gamma_d = 1.5;
};

enum class Eq12 { kCorrected, kLiteral };
enum class FilterWindow { kDisc, kSquare };
enum class FilterWeighting { kPerPiece, kPerSample };
enum class FilterGranularity {
  kPiece,   // samples stand at the centre of their piece
  kSample,  // at their film position, where recorded; else as kPiece
};
struct FilterOptions {
  Eq12 eq12 = Eq12::kCorrected;
  FilterWindow window = FilterWindow::kDisc;
  FilterWeighting weighting = FilterWeighting::kPerPiece;
  FilterGranularity granularity = FilterGranularity::kPiece;
};

// Whose samples decide about size and shape of the filter of which.
enum class Deciding {
  kOwn,     // all of the piece's about all
  kHalves,  // each half of a piece's samples about the other: what is averaged decides nothing
};

// What size 1 means; the filter's taps are exp(-2 d^2) - exp(-8), d = -1, 0, 1.
enum class BaseImage {
  kChosen,         // each piece's mean, or the filtered one: the first step of eq 9
  kPixelGaussian,  // the filtered mean of every piece
  kNone,
};
enum class ReconstructionScope { kGlobal, kTile };
enum class Precision { kFloat32, kFloat64 };  // of bands, energies and weights; sums are double

struct DirectionalOptions {
  Deciding decide = Deciding::kOwn;
  bool normalise_exposure = true;
  VarianceMode var_mode = VarianceMode::kAuto;
  int noise_pool = 8;  // largest radius of the pool of a variance, pieces; 0: own samples alone
  BaseImage base = BaseImage::kChosen;
  PyramidOptions pyramid;
  FilterSizeOptions size;
  BankOptions bank;
  EnergyOptions energy;
  FilterWidthOptions width;
  FilterOptions filter;
  ReconstructionScope scope = ReconstructionScope::kGlobal;
  int tile = 64;
  Precision precision = Precision::kFloat32;
};

DirectionalOptions robust_directional_options();
DirectionalOptions paper_directional_options();

OptionTable<DirectionalOptions> directional_option_table();
std::vector<Reading> directional_readings();

}  // namespace spool
