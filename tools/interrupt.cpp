#include "tools/interrupt.h"

#include <unistd.h>
#include <csignal>
#include <cstdlib>
#include <mutex>
#include <thread>
#include <utility>

#include <fmt/format.h>

#include "lib/image_io/atomic_file.h"
#include "tools/methods/external_process.h"

namespace spool::tools {
namespace {

struct Note {
  std::mutex mutex;
  std::function<std::string()> text;
};

Note& note() {
  static Note instance;
  return instance;
}

std::string note_text() {
  const std::scoped_lock lock(note().mutex);
  return note().text ? "; " + note().text() : "";
}

}  // namespace

InterruptNote::InterruptNote(std::function<std::string()> text) {
  const std::scoped_lock lock(note().mutex);
  note().text = std::move(text);
}

InterruptNote::~InterruptNote() {
  const std::scoped_lock lock(note().mutex);
  note().text = nullptr;
}

void watch_for_interrupts() {
  sigset_t signals;
  sigemptyset(&signals);
  sigaddset(&signals, SIGINT);
  sigaddset(&signals, SIGTERM);
  if (pthread_sigmask(SIG_BLOCK, &signals, nullptr) != 0) return;
  std::thread([signals] {
    int signal = 0;
    if (sigwait(&signals, &signal) != 0) return;
    end_external_work();
    remove_unfinished_files();
    fmt::print(stderr, "\r\033[Kspool: interrupted; unfinished files were removed{}\n",
               note_text());
    ::_exit(128 + signal);
  }).detach();
}

}  // namespace spool::tools
