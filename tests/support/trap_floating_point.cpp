// Linked into every test program: with SPOOL_TRAP_FLOATING_POINT=1 an invalid operation or a
// division by zero ends the program with a stack trace, except in the tests that
// tests/support/floating_point_exceptions.txt names, one a line, each with its reason.
//
// Threads inherit the mask of the thread that makes them, so it is set before main. One test per
// process (as ctest runs them), or a name of the list would loosen the tests after it.
#include <execinfo.h>
#include <unistd.h>
#include <cfenv>
#include <csignal>
#include <cstdlib>
#include <fstream>
#include <set>
#include <string>

#include <gtest/gtest.h>

#include "tests/support/source_directory.h"

namespace {

constexpr int kTrapped = FE_INVALID | FE_DIVBYZERO;

extern "C" void report_trap(int) {
  static const char message[] = "floating-point exception trapped:\n";
  [[maybe_unused]] const auto written = ::write(STDERR_FILENO, message, sizeof message - 1);
  void* frames[32];
  ::backtrace_symbols_fd(frames, ::backtrace(frames, 32), STDERR_FILENO);
  std::_Exit(3);
}

std::set<std::string> allowed_tests() {
  std::ifstream list(spool::test::source_directory() /
                     "tests/support/floating_point_exceptions.txt");
  std::set<std::string> names;
  for (std::string line; std::getline(list, line);) {
    if (!line.empty() && line[0] != '#') names.insert(line.substr(0, line.find(' ')));
  }
  return names;
}

class Trap : public testing::EmptyTestEventListener {
 public:
  void OnTestStart(const testing::TestInfo& test) override {
    const std::string name = std::string(test.test_suite_name()) + "." + test.name();
    if (allowed_.count(name) > 0) ::fedisableexcept(kTrapped);
  }

 private:
  std::set<std::string> allowed_ = allowed_tests();
};

[[maybe_unused]] const bool kSet = [] {
  if (std::getenv("SPOOL_TRAP_FLOATING_POINT") == nullptr) return false;
  std::signal(SIGFPE, report_trap);
  testing::UnitTest::GetInstance()->listeners().Append(new Trap);
  return ::feenableexcept(kTrapped) != -1;
}();

}  // namespace
