#include "tools/terminal/interrupt.h"

#include <unistd.h>
#include <csignal>
#include <cstdlib>
#include <mutex>
#include <thread>
#include <utility>

#include <fmt/core.h>

#include "formats/unfinished_files.h"
#include "lib/core/visible_text.h"
#include "tools/methods/watched_process.h"
#include "tools/terminal/console.h"

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
  sigaddset(&signals, SIGQUIT);
  // Under nohup the end of the terminal is no reason to stop.
  struct sigaction hangup{};
  if (sigaction(SIGHUP, nullptr, &hangup) == 0 && hangup.sa_handler != SIG_IGN) {
    sigaddset(&signals, SIGHUP);
  }
  if (pthread_sigmask(SIG_BLOCK, &signals, nullptr) != 0) return;
  std::thread([signals] {
    int signal = 0;
    if (sigwait(&signals, &signal) != 0) return;
    end_external_work();
    format::remove_unfinished_files();
    print_raw_error(fmt::format("{}spool: interrupted; unfinished files were removed{}\n",
                                line_eraser(), visible_text(note_text())));
    ::_exit(128 + signal);
  }).detach();
}

}  // namespace spool::tools
