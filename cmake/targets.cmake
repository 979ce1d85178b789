# What every target of Spool shares, and the two functions that make targets.

# What whoever includes a header needs. -ffp-contract=off: a*b+c must have one result on every target; results are
# promised bit for bit.
add_library(spool_headers INTERFACE)
target_include_directories(spool_headers INTERFACE $<BUILD_INTERFACE:${PROJECT_SOURCE_DIR}>
  $<INSTALL_INTERFACE:include/spool>)
target_compile_features(spool_headers INTERFACE cxx_std_20)
target_compile_options(spool_headers INTERFACE -ffp-contract=off)

# What only the project's own sources are held to.
add_library(spool_flags INTERFACE)
target_link_libraries(spool_flags INTERFACE spool_headers)
# -Werror=psabi: a wide vector that is passed by value between a clone and another function (lib/core/vector_clones.h).
# -Wno-restrict: g++ 12 warns falsely about std::string (its bug 105651).
# clang++: libstdc++'s std::stable_sort calls what it declares deprecated; `#pragma GCC ivdep` is not known.
target_compile_options(spool_flags INTERFACE
  -ffp-contract=off -Wall -Wextra -Wshadow -Wconversion -Wno-sign-conversion -Werror=psabi
  $<$<CXX_COMPILER_ID:GNU>:-Wno-restrict>
  $<$<CXX_COMPILER_ID:Clang>:-Wno-deprecated-declarations;-Wno-unknown-pragmas>)

# Headers of others that most sources include, parsed once. Each source still includes what it uses; a build with
# SPOOL_PRECOMPILE=OFF holds it to that.
option(SPOOL_PRECOMPILE "Parse the headers that most sources share once" ON)
set(SPOOL_SHARED_HEADERS <algorithm> <array> <cstddef> <cstdint> <filesystem> <functional> <map> <memory> <optional>
  <span> <string> <string_view> <utility> <vector> <fmt/core.h> <tl/expected.hpp>)

# ccache takes what uses precompiled headers only with these words.
if(SPOOL_PRECOMPILE AND CMAKE_CXX_COMPILER_LAUNCHER MATCHES "ccache$")
  set(CMAKE_CXX_COMPILER_LAUNCHER env CCACHE_SLOPPINESS=pch_defines,time_macros ${CMAKE_CXX_COMPILER_LAUNCHER})
  target_compile_options(spool_flags INTERFACE $<$<CXX_COMPILER_ID:GNU>:-fpch-preprocess>)
endif()

# spool_precompile(TARGET KIND HEADERS...): TARGET uses the precompiled headers of its KIND; the first one makes them.
function(spool_precompile target kind)
  if(NOT SPOOL_PRECOMPILE)
    return()
  endif()
  if(NOT TARGET spool_precompiled_${kind})
    file(WRITE ${PROJECT_BINARY_DIR}/precompiled_${kind}.cpp "")
    add_library(spool_precompiled_${kind} OBJECT ${PROJECT_BINARY_DIR}/precompiled_${kind}.cpp)
    target_link_libraries(spool_precompiled_${kind} PRIVATE spool_flags fmt::fmt tl::expected)
    if(kind STREQUAL library)
      set_target_properties(spool_precompiled_library PROPERTIES POSITION_INDEPENDENT_CODE ON
        CXX_VISIBILITY_PRESET hidden VISIBILITY_INLINES_HIDDEN ON)
    else()
      target_link_libraries(spool_precompiled_${kind} PRIVATE GTest::gtest GTest::gmock)
      target_compile_options(spool_precompiled_${kind} PRIVATE ${SPOOL_TEST_OPTIONS})
    endif()
    target_precompile_headers(spool_precompiled_${kind} PRIVATE ${SPOOL_SHARED_HEADERS} ${ARGN})
  endif()
  target_precompile_headers(${target} REUSE_FROM spool_precompiled_${kind})
  # g++ 12 takes what is inlined from a precompiled standard header for the project's own, and warns of it, falsely.
  target_compile_options(${target} PRIVATE
    $<$<CXX_COMPILER_ID:GNU>:-Wno-array-bounds;-Wno-stringop-overflow;-Wno-stringop-overread>)
endfunction()

# spool_library(NAME SOURCES... LIBS... [INTERNAL]): a static library of one folder. Others call spool_core spool::core,
# built beside or installed; one that is INTERNAL is not for others. It can become part of a shared one (the Python
# module), and what it holds is then seen in there only.
function(spool_library name)
  cmake_parse_arguments(ARG "INTERNAL" "" "SOURCES;LIBS" ${ARGN})
  add_library(${name} STATIC ${ARG_SOURCES})
  target_link_libraries(${name} PRIVATE $<BUILD_INTERFACE:spool_flags> PUBLIC spool_headers ${ARG_LIBS})
  set_target_properties(${name} PROPERTIES POSITION_INDEPENDENT_CODE ON
    CXX_VISIBILITY_PRESET hidden VISIBILITY_INLINES_HIDDEN ON)
  spool_precompile(${name} library)
  if(NOT ARG_INTERNAL)
    string(REGEX REPLACE "^spool_" "" component ${name})
    set_target_properties(${name} PROPERTIES EXPORT_NAME ${component})
    add_library(spool::${component} ALIAS ${name})
    set_property(GLOBAL APPEND PROPERTY SPOOL_COMPONENTS ${component})
  endif()
endfunction()

# Time limits of tests are for a plain build; sanitizers are several times slower.
set(SPOOL_TIMEOUT_FACTOR 1)
if(CMAKE_CXX_FLAGS MATCHES "fsanitize=thread")
  set(SPOOL_TIMEOUT_FACTOR 10)
elseif(CMAKE_CXX_FLAGS MATCHES "fsanitize=address")
  set(SPOOL_TIMEOUT_FACTOR 4)
endif()

# The code of a test runs once: less time in the compiler is worth more than fast loops, but in slow twins of kernels.
set(SPOOL_TEST_OPTIONS $<$<CONFIG:Release>:-O1>)

# spool_test(MODULE LABEL SOURCES... LIBS...): one test program per module and label; ctest -L LABEL selects it.
function(spool_test module label)
  cmake_parse_arguments(ARG "" "TIMEOUT" "SOURCES;LIBS" ${ARGN})
  if(NOT ARG_TIMEOUT)
    set(ARG_TIMEOUT 300)
  endif()
  math(EXPR ARG_TIMEOUT "${ARG_TIMEOUT} * ${SPOOL_TIMEOUT_FACTOR}")
  set(program test_${module}_${label})
  if(NOT TARGET spool_every_test)
    add_library(spool_every_test OBJECT ${PROJECT_SOURCE_DIR}/tests/support/trap_floating_point.cpp
      ${PROJECT_SOURCE_DIR}/tests/support/source_directory.cpp)
    target_link_libraries(spool_every_test PRIVATE spool_flags GTest::gtest)
    target_compile_definitions(spool_every_test PRIVATE SPOOL_SOURCE_DIR="${PROJECT_SOURCE_DIR}")
  endif()
  add_executable(${program} ${ARG_SOURCES} $<TARGET_OBJECTS:spool_every_test>)
  target_link_libraries(${program} PRIVATE spool_flags GTest::gtest GTest::gtest_main GTest::gmock
    ${ARG_LIBS})
  target_compile_options(${program} PRIVATE ${SPOOL_TEST_OPTIONS})
  spool_precompile(${program} tests <gmock/gmock.h> <gtest/gtest.h>)
  gtest_discover_tests(${program} TEST_PREFIX "${module}." DISCOVERY_TIMEOUT 120
    PROPERTIES LABELS ${label} TIMEOUT ${ARG_TIMEOUT})
endfunction()

# spool_pytest(NAME LABEL ARGS... ENVIRONMENT...): a Python test of the current folder, run by Debian's interpreter
# (which has numpy and pytest; one that comes first on PATH may not). Exit 77 is "skipped, and said so".
function(spool_pytest name label)
  cmake_parse_arguments(ARG "" "TIMEOUT" "ARGS;ENVIRONMENT;COMMAND" ${ARGN})
  if(NOT ARG_TIMEOUT)
    set(ARG_TIMEOUT 600)
  endif()
  math(EXPR ARG_TIMEOUT "${ARG_TIMEOUT} * ${SPOOL_TIMEOUT_FACTOR}")
  if(NOT ARG_COMMAND)
    set(ARG_COMMAND ${Python3_EXECUTABLE} -m pytest -q -p no:cacheprovider ${ARG_ARGS})
  endif()
  add_test(NAME ${name} COMMAND ${ARG_COMMAND} WORKING_DIRECTORY ${CMAKE_CURRENT_SOURCE_DIR})
  set_tests_properties(${name} PROPERTIES LABELS ${label} TIMEOUT ${ARG_TIMEOUT} SKIP_RETURN_CODE 77
    ENVIRONMENT "PYTHONDONTWRITEBYTECODE=1;PYTHONPATH=${PROJECT_SOURCE_DIR}:${PROJECT_SOURCE_DIR}/formats/python;${ARG_ENVIRONMENT}")
  set_property(TEST ${name} APPEND PROPERTY ENVIRONMENT SPOOL_TIMEOUT_FACTOR=${SPOOL_TIMEOUT_FACTOR})
endfunction()
