// Counts what a program holds on its heap, by replacing operator new: the peak memory of one call
// to the byte, apart from the mapped pool. (Peak resident memory would count pages of the pool.)
#pragma once

namespace spool::bench {

long long heap_bytes();
// The most that was held since the last reset.
long long heap_peak();
void reset_heap_peak();

}  // namespace spool::bench
