// Threads of one's own for a few large pieces of work, each of which is then serial.
#pragma once

#include <cstddef>
#include <functional>

namespace spool {

// Threads that parallel loops may use now.
int allowed_threads();

// body(i) for i = 0 .. n-1, each on one of `threads` threads of their own, begun in this order;
// parallel loops inside a body stay on its thread. The first exception of a body ends what has not
// begun, and is thrown here.
void for_each_on_threads(std::size_t n, int threads, const std::function<void(std::size_t)>& body);

}  // namespace spool
