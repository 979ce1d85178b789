// What goes through all samples while a recording is read for the first time, each row of a block
// while the processor's cache holds it: a second pass over the samples costs what reading memory
// costs.
#pragma once

#include "lib/pool/layer_blocks.h"

namespace spool {

class FirstPass {
 public:
  virtual ~FirstPass() = default;

  // Before the first row.
  virtual void begin(const LayerGrid& grid) = 0;
  // values [x][s] of a channel of row y, of all samples of the block as they were recorded, before
  // any rule. The blocks of a tile in their order, on one thread; tiles in any order, on any.
  virtual void see(const BlockRow& row) = 0;
};

}  // namespace spool
