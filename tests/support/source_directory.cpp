#include "tests/support/source_directory.h"

namespace spool::test {

// One file knows the folder, so that the objects of the others are the same in every checkout.
std::filesystem::path source_directory() {
  return SPOOL_SOURCE_DIR;
}

}  // namespace spool::test
