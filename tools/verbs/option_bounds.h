// What the numbers of a verb may be. Each verb checks its own once, in validate(), whatever hands
// them over: the command line, the Python module, or a program that links this library.
#pragma once

#include <cstdint>
#include <string_view>

#include "lib/core/error.h"
#include "lib/pool/sample_pool.h"

namespace spool::tools {

struct Bounds {
  double lowest, highest;
};

inline constexpr Bounds kBudget = {1e-3, 65536.0};  // samples per pixel on average
inline constexpr Bounds kSamples = {1, 65536};      // of a pixel; 0 where it means all
inline constexpr Bounds kHoldout = {0, 65535};
inline constexpr Bounds kPiecesPerSide = {1, 2};
inline constexpr Bounds kThreads = {0, 1024};
inline constexpr Bounds kReplicates = {1, 10000};  // as in a plan
inline constexpr Bounds kRepeats = {1, 1000};
inline constexpr Bounds kExposure = {-100, 100};  // EV
inline constexpr Bounds kImageMb = {0, 1e6};      // megabytes of images in a page
inline constexpr Bounds kShownMb = {1e-3, 1e6};   // where it holds images of which none is left out
inline constexpr Bounds kSignificance = {0, 1};
inline constexpr Bounds kTolerance = {0, 1e6};    // a relative change
inline constexpr Bounds kPort = {0, 65535};       // 0: any
inline constexpr Bounds kFigureSpp = {0, 65536};  // 0: the largest
inline constexpr Bounds kColumns = {0, 2};        // 0: as many as a figure needs

// kUsage outside the bounds, and of NaN.
Result<void> check_bounds(std::string_view name, double value, const Bounds& bounds);
// As TOML has whole numbers.
Result<void> check_seed(std::uint64_t seed);

Result<void> validate(const PoolOptions& pool);

}  // namespace spool::tools
