// Raw bytes -> recover; whatever comes out passes the check.
#include "formats/dump_check.h"
#include "formats/spool_recovery.h"
#include "tests/formats/crc_repair.h"
#include "tests/fuzz/fuzz_input.h"

extern "C" int LLVMFuzzerTestOneInput(const uint8_t* data, size_t size) {
  using namespace spool::format;
  Bytes file = bytes_of(data, size);
  // Half of the inputs with right checksums, or nothing would ever be kept.
  if (file.size() >= 2 * kUnit && (data[size - 1] & 1) != 0) {
    for (size_t at = kUnit; at + kUnit <= file.size(); at += kUnit) {
      if (load<std::array<uint8_t, 4>>(file, at) != kSyncBytes) continue;
      seal_payload(file, at);
      seal_unit(file, at);
    }
    seal_unit(file, 0);
  }
  write_bytes(fuzz_file("in"), file);
  const auto report = recover_dump(fuzz_file("in"), fuzz_file("out"), true);
  if (!report) {
    demand(report.error().code != spool::ErrorCode::kIo,
           "recovery does not fail by its own output");
    return 0;
  }
  const auto check = check_dump(fuzz_file("out"));
  demand(check && check->intact(), "a recovered file is intact");
  demand(check->records == report->kept_records + 1, "all kept records are in the file");
  demand(read_bytes(fuzz_file("in")) == file, "the input is not touched");
  return 0;
}
