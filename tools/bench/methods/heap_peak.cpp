#include "tools/bench/methods/heap_peak.h"

#include <malloc.h>

#include <atomic>
#include <cstdlib>
#include <new>

namespace spool::bench {
namespace {

std::atomic<long long> live{0}, peak{0};

void* counted(void* memory) {
  if (memory == nullptr) throw std::bad_alloc();
  const auto size = static_cast<long long>(malloc_usable_size(memory));
  const long long now = live.fetch_add(size, std::memory_order_relaxed) + size;
  long long before = peak.load(std::memory_order_relaxed);
  while (now > before && !peak.compare_exchange_weak(before, now, std::memory_order_relaxed)) {
  }
  return memory;
}

void release(void* memory) {
  if (memory == nullptr) return;
  live.fetch_sub(static_cast<long long>(malloc_usable_size(memory)), std::memory_order_relaxed);
  std::free(memory);
}

std::size_t whole_multiple(std::size_t size, std::align_val_t alignment) {
  const auto a = static_cast<std::size_t>(alignment);
  return (size + a - 1) / a * a;
}

}  // namespace

long long heap_bytes() {
  return live.load();
}
long long heap_peak() {
  return peak.load();
}
void reset_heap_peak() {
  peak.store(live.load());
}

}  // namespace spool::bench

void* operator new(std::size_t size) {
  return spool::bench::counted(std::malloc(size));
}
void* operator new(std::size_t size, std::align_val_t alignment) {
  return spool::bench::counted(std::aligned_alloc(static_cast<std::size_t>(alignment),
                                                  spool::bench::whole_multiple(size, alignment)));
}
void operator delete(void* memory) noexcept {
  spool::bench::release(memory);
}
void operator delete(void* memory, std::size_t) noexcept {
  spool::bench::release(memory);
}
void operator delete(void* memory, std::align_val_t) noexcept {
  spool::bench::release(memory);
}
void operator delete(void* memory, std::size_t, std::align_val_t) noexcept {
  spool::bench::release(memory);
}
