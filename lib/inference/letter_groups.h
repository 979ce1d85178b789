// Letters for methods, such that two share a letter exactly where they are not separated
// [Piepho04].
#pragma once

#include <functional>
#include <string>
#include <vector>

namespace spool {

// Letters of items 0 .. count-1, the first letters to the first items. `apart(i, j)`, i < j: they
// are separated. Groups are the maximal sets in which no two are separated, none of which the
// others make needless; of more than 20000 such sets none is named, and all texts are empty.
std::vector<std::string> letter_groups(std::size_t count,
                                       const std::function<bool(std::size_t, std::size_t)>& apart);

}  // namespace spool
