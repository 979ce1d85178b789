#include "tools/interrupt.h"

#include <unistd.h>
#include <csignal>
#include <cstdlib>
#include <thread>

#include <fmt/format.h>

#include "lib/image_io/atomic_file.h"

namespace spool::tools {

void watch_for_interrupts() {
  sigset_t signals;
  sigemptyset(&signals);
  sigaddset(&signals, SIGINT);
  sigaddset(&signals, SIGTERM);
  if (pthread_sigmask(SIG_BLOCK, &signals, nullptr) != 0) return;
  std::thread([signals] {
    int signal = 0;
    if (sigwait(&signals, &signal) != 0) return;
    remove_unfinished_files();
    fmt::print(stderr, "\r\033[Kspool: interrupted; unfinished files were removed\n");
    ::_exit(128 + signal);
  }).detach();
}

}  // namespace spool::tools
