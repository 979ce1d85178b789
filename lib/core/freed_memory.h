// What becomes of memory that was freed.
#pragma once

namespace spool {

// Called once by a program that works on many images of one size, one after the other: blocks up to
// 32 MB stay with the process when they are freed, where the C library would hand each back to the
// system and let the next one fault in page by page (a third of the time of the directional filter
// at 1024x1024). Does nothing with another C library than glibc.
void keep_freed_memory();

}  // namespace spool
