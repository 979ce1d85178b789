// Mapped files whose pages are lost while they are read: the file was cut or overwritten, or the
// disk or server that holds it failed. The kernel then sends SIGBUS, which ends a process at once.
//
// survive_lost_pages() makes that an error instead. Its handler puts pages of zeros in the place of
// what was lost, which is a system call and no more, and marks the range; the reader goes on over
// zeros, and the reader asks afterwards. A SIGBUS of any other address goes where it went before.
#pragma once

#include <cstddef>

namespace spool::format {

// For the whole process, once; the program calls it at its start. A library that does not call it
// keeps what POSIX does.
void survive_lost_pages();

// Ranges that may be watched at one time; more are mapped and read as before.
inline constexpr int kMaxWatchedRanges = 256;

// The number of the range, or -1 when all are taken. From any thread.
int watch_range(const void* begin, std::size_t bytes);
// Before the range is unmapped.
void forget_range(int range);
// Whether pages of the range were lost since it was watched.
bool lost_pages(int range);

}  // namespace spool::format
