// Which pieces of a region are sampled, by either rule of the region-based samplers.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "lib/core/option_table.h"
#include "lib/pool/sample_pool.h"

namespace spool {

// A piece of the grid that still has samples to offer.
struct OpenPiece {
  int n = 0;  // samples it has
  int x = 0, y = 0;
};

struct PieceShare {
  int x = 0, y = 0;
  int count = 0;
};

// One sample each, for the first in the order (n, y, x) when fewer than that are left.
std::vector<PieceShare> one_each(std::vector<OpenPiece> pieces, long long left);

// `wanted` samples one by one to the least-sampled piece, ties by a hash of `seed` and the piece;
// fewer when all run out.
std::vector<PieceShare> to_least_sampled(const std::vector<OpenPiece>& pieces,
                                         const SamplePool& pool, long long wanted,
                                         std::uint64_t seed);

// An option that reads "WORD" (one sample each, empty) or "fixed(m)".
template <class Options>
Option<Options> pop_option(std::string name, std::string word,
                           std::optional<int> Options::* member) {
  return {name, word + "|fixed(1 .. 65536)",
          "samples of a region: one for each piece, or m for its least-sampled pieces",
          [=](Options& options, std::string_view text) -> Result<void> {
            if (text == word) {
              (options.*member).reset();
              return {};
            }
            if (!text.starts_with("fixed(") || !text.ends_with(")")) {
              return fail(ErrorCode::kUsage, "option {}: '{}' is not {} or fixed(m)", name, text,
                          word);
            }
            SPOOL_ASSIGN(const int value,
                         parse_integer(name, text.substr(6, text.size() - 7), 1, 65536));
            options.*member = value;
            return {};
          },
          [=](const Options& options) {
            return options.*member ? fmt::format("fixed({})", *(options.*member)) : word;
          }};
}

}  // namespace spool
