// Where the sources lie, for tests that read files of the tree.
#pragma once

#include <filesystem>

namespace spool::test {

std::filesystem::path source_directory();

}  // namespace spool::test
