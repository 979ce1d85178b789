#include "tools/run_manifest.h"

#include <ctime>
#include <fstream>
#include <iterator>
#include <string>
#include <thread>

#include <fmt/chrono.h>
#include <sys/utsname.h>
#include <unistd.h>
#include <nlohmann/json.hpp>

#include "formats/interchange/sha256.h"

namespace spool::tools {
namespace {

using nlohmann::ordered_json;

// As a shell would take it again.
std::string quoted(const std::string& word) {
  constexpr std::string_view kPlain =
      "abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ0123456789_-./=,:+%@";
  if (!word.empty() && word.find_first_not_of(kPlain) == std::string::npos) return word;
  std::string text = "'";
  for (const char c : word)
    text += c == '\'' ? std::string("'\\''") : std::string(1, c);
  return text + "'";
}

// The words of this process's command line, as the system keeps them; empty where it does not.
std::string command_line() {
  std::ifstream file("/proc/self/cmdline", std::ios::binary);
  const std::string bytes{std::istreambuf_iterator<char>(file), {}};
  std::string text;
  for (std::size_t at = 0; at < bytes.size();) {
    const std::size_t end = std::min(bytes.find('\0', at), bytes.size());
    text += (text.empty() ? "" : " ") + quoted(bytes.substr(at, end - at));
    at = end + 1;
  }
  return text;
}

std::string processor() {
  std::ifstream file("/proc/cpuinfo");
  for (std::string line; std::getline(file, line);) {
    const std::size_t colon = line.find(": ");
    if (line.starts_with("model name") && colon != std::string::npos) return line.substr(colon + 2);
  }
  return "unknown processor";
}

ordered_json machine() {
  utsname system{};
  uname(&system);
  const double bytes =
      static_cast<double>(sysconf(_SC_PHYS_PAGES)) * static_cast<double>(sysconf(_SC_PAGESIZE));
  return {{"processor", processor()},
          {"threads", std::thread::hardware_concurrency()},
          {"memory", fmt::format("{:.1f} GB", bytes / 1e9)},
          {"system", fmt::format("{} {} {}", system.sysname, system.release, system.machine)},
          {"compiler", __VERSION__}};
}

}  // namespace

Result<void> write_manifest(const std::filesystem::path& folder, const RunManifest& run) {
  using std::chrono::system_clock;
  const std::chrono::duration<double> taken = system_clock::now() - run.started;
  ordered_json manifest = {
      {"command", command_line()},
      {"version", "spool " SPOOL_VERSION},
      {"machine", machine()},
      {"started",
       fmt::format("{:%Y-%m-%dT%H:%M:%SZ}", fmt::gmtime(system_clock::to_time_t(run.started)))},
      {"seconds", taken.count()},
      {"dumps", ordered_json::array()}};
  for (const std::filesystem::path& dump : run.dumps) {
    SPOOL_ASSIGN(const std::string digest, interchange::sha256_of(dump));
    manifest["dumps"].push_back(
        {{"path", dump.string()}, {"bytes", std::filesystem::file_size(dump)}, {"sha256", digest}});
  }
  const std::filesystem::path target = folder / "manifest.json";
  const std::filesystem::path partial = folder / "manifest.json.partial";
  {
    std::ofstream file(partial, std::ios::binary);
    file << manifest.dump(2, ' ', false, ordered_json::error_handler_t::replace) << '\n';
    if (!file.flush()) return fail(ErrorCode::kIo, "{}: cannot be written", partial.string());
  }
  std::error_code status;
  std::filesystem::rename(partial, target, status);
  if (status) return fail(ErrorCode::kIo, "{}: {}", target.string(), status.message());
  return {};
}

}  // namespace spool::tools
