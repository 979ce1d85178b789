# What every target of Spool shares, and the two functions that make targets.

add_library(spool_flags INTERFACE)
target_include_directories(spool_flags INTERFACE ${PROJECT_SOURCE_DIR})
# -ffp-contract=off: a*b+c must have one result on every target; results are promised bit for bit.
# -Wno-restrict: g++ 12 warns falsely about std::string (its bug 105651).
target_compile_options(spool_flags INTERFACE
  -ffp-contract=off -Wall -Wextra -Wshadow -Wconversion -Wno-sign-conversion -Wno-psabi
  $<$<CXX_COMPILER_ID:GNU>:-Wno-restrict>)

# spool_library(NAME SOURCES... LIBS...): a static library of one folder.
function(spool_library name)
  cmake_parse_arguments(ARG "" "" "SOURCES;LIBS" ${ARGN})
  add_library(${name} STATIC ${ARG_SOURCES})
  target_link_libraries(${name} PUBLIC spool_flags ${ARG_LIBS})
endfunction()

# spool_test(MODULE LABEL SOURCES... LIBS...): one test program per module and label; ctest -L LABEL selects it.
function(spool_test module label)
  cmake_parse_arguments(ARG "" "TIMEOUT" "SOURCES;LIBS" ${ARGN})
  if(NOT ARG_TIMEOUT)
    set(ARG_TIMEOUT 300)
  endif()
  set(program test_${module}_${label})
  add_executable(${program} ${ARG_SOURCES})
  target_link_libraries(${program} PRIVATE spool_flags GTest::gtest GTest::gtest_main GTest::gmock
    ${ARG_LIBS})
  target_compile_definitions(${program} PRIVATE SPOOL_SOURCE_DIR="${PROJECT_SOURCE_DIR}")
  gtest_discover_tests(${program} TEST_PREFIX "${module}." DISCOVERY_TIMEOUT 120
    PROPERTIES LABELS ${label} TIMEOUT ${ARG_TIMEOUT})
endfunction()
