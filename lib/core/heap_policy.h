// What the process keeps of memory that it no longer uses.
#pragma once

namespace spool {

// Called once by a program that works on many images of one size, one after the other: freed blocks
// stay with the process (up to 1 GB at the end of the heap), where the C library would hand each
// back to the system and let the next one fault in page by page: half the time of the directional
// filter at 1024x1024. Does nothing with another C library than glibc.
void keep_freed_memory();

}  // namespace spool
