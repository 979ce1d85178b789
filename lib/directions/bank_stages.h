// The split stages of the directional filter bank's tree: vectors p and q of each.
#pragma once

namespace spool {

struct BankVector {
  int x = 0, y = 0;
};
inline BankVector operator*(int factor, BankVector v) {
  return {factor * v.x, factor * v.y};
}

// The vectors p and q of a stage.
struct BankStage {
  BankVector p, q;
};
inline constexpr BankStage kHorizontalOrVertical = {{1, 1}, {1, -1}};  // "+": |wx| > |wy|
inline constexpr BankStage kDiagonal = {{2, 0}, {0, 2}};               // "+": wx wy > 0
// "+": the half of a wedge that lies towards the diagonal; s is the sign of wx wy.
constexpr BankStage split_of_horizontal(int s) {
  return {{-s, 2}, {s, 0}};
}
constexpr BankStage split_of_vertical(int s) {
  return {{2, -s}, {0, s}};
}

}  // namespace spool
