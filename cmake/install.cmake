# What `cmake --install` carries, by component:
#   program  the program, and what `spool report` and `spool figure` run
#   png      the module that writes PNG pictures; it alone needs OpenImageIO
#   dev      headers, static libraries, and what find_package(spool) and pkg-config read
#   python   the numpy reader and writer as a package of Debian's Python; only when asked for by its name
include(CMakePackageConfigHelpers)

get_property(components GLOBAL PROPERTY SPOOL_COMPONENTS)
list(TRANSFORM components PREPEND "spool_" OUTPUT_VARIABLE libraries)

# Each package carries its licence, and texts and an SPDX list of what it contains of others: known when all is built.
function(spool_licences component name)
  list(JOIN ARGN " " arguments)
  install(CODE "execute_process(COMMAND python3 ${PROJECT_SOURCE_DIR}/tools/package/bundled.py build
    ${PROJECT_BINARY_DIR} \"\$ENV{DESTDIR}\${CMAKE_INSTALL_PREFIX}/share/doc/${name}\" --name ${name} ${arguments}
    COMMAND_ERROR_IS_FATAL ANY)" COMPONENT ${component} ${excluded})
endfunction()
set(png_module lib/image_io/CMakeFiles/spool_png.dir)
if(NOT SKBUILD)
  set(without_module --without tools/python tools/bench ${png_module})
endif()
spool_licences(program spool --of lib formats tools --scripts ${without_module})
if(NOT SKBUILD)
  spool_licences(png spool-png --of ${png_module})
  spool_licences(dev libspool-dev --of lib formats --without ${png_module})
  set(excluded EXCLUDE_FROM_ALL)
  spool_licences(python python3-spool)
endif()

# --- program -----------------------------------------------------------------------------------

if(SPOOL_BUILD_PROGRAM)
  install(TARGETS spool COMPONENT program)
  install(TARGETS spool_png LIBRARY DESTINATION lib/spool COMPONENT png)
  # The scripts of others that a report carries are installed where they were fetched before.
  set(spool_report_assets "$ENV{SPOOL_REPORT_ASSETS}")
  if(NOT spool_report_assets AND DEFINED ENV{HOME})
    set(spool_report_assets "$ENV{HOME}/.cache/spool/report-assets")
  endif()
  file(STRINGS tools/report/assets.sha256 pinned REGEX "[^ ]+$")
  list(TRANSFORM pinned REPLACE "^[^ ]+ +" "${spool_report_assets}/")
  install(FILES ${pinned} DESTINATION share/spool/tools/report/assets COMPONENT program OPTIONAL)
  install(FILES tools/__init__.py DESTINATION share/spool/tools COMPONENT program)
  install(DIRECTORY tools/report DESTINATION share/spool/tools COMPONENT program PATTERN "__pycache__" EXCLUDE
    PATTERN "*.sh" PERMISSIONS OWNER_READ OWNER_WRITE OWNER_EXECUTE GROUP_READ GROUP_EXECUTE
    WORLD_READ WORLD_EXECUTE)
  install(DIRECTORY formats/python/spool DESTINATION share/spool/formats/python COMPONENT program PATTERN "__pycache__" EXCLUDE)
endif()

# Completions and manual pages say what the program says of itself. A program under a sanitizer may not start here.
if(SPOOL_BUILD_PROGRAM AND NOT CMAKE_CXX_FLAGS MATCHES "fsanitize")
  set(manual ${PROJECT_BINARY_DIR}/manual)
  add_custom_command(OUTPUT ${manual}/spool.bash ${manual}/_spool ${manual}/spool.fish ${manual}/man1/spool.1
    COMMAND ${CMAKE_COMMAND} -E make_directory ${manual}
    COMMAND spool completion bash > ${manual}/spool.bash
    COMMAND spool completion zsh > ${manual}/_spool
    COMMAND spool completion fish > ${manual}/spool.fish
    COMMAND spool man --force -o ${manual}/man1
    DEPENDS spool VERBATIM)
  add_custom_target(spool_manual ALL DEPENDS ${manual}/spool.bash)
  install(FILES ${manual}/spool.bash DESTINATION share/bash-completion/completions RENAME spool COMPONENT program)
  install(FILES ${manual}/_spool DESTINATION share/zsh/vendor-completions COMPONENT program)
  install(FILES ${manual}/spool.fish DESTINATION share/fish/vendor_completions.d COMPONENT program)
  install(DIRECTORY ${manual}/man1 DESTINATION share/man COMPONENT program)
endif()
install(DIRECTORY formats/python/spool DESTINATION lib/python3/dist-packages COMPONENT python EXCLUDE_FROM_ALL
  PATTERN "__pycache__" EXCLUDE)

# --- dev ---------------------------------------------------------------------------------------

# Sources write #include "lib/core/image.h", in the tree and outside.
install(DIRECTORY formats lib DESTINATION include/spool COMPONENT dev FILES_MATCHING PATTERN "*.h"
  PATTERN "python" EXCLUDE)
install(TARGETS spool_headers ${libraries} EXPORT spool ARCHIVE DESTINATION lib/spool COMPONENT dev)
install(EXPORT spool FILE spoolTargets.cmake NAMESPACE spool:: DESTINATION lib/cmake/spool COMPONENT dev)

# How a library that the targets link is found again, and what pkg-config calls it.
set("found_TBB::tbb" "TBB 2021.8 CONFIG COMPONENTS tbb")
set("found_fmt::fmt" "fmt 9.1 CONFIG")
set("found_tl::expected" "tl-expected 1.0 CONFIG")
set("found_zstd::libzstd_shared" "zstd 1.5 CONFIG")
set("found_nlohmann_json::nlohmann_json" "nlohmann_json 3.11 CONFIG")
set("found_tomlplusplus::tomlplusplus" "tomlplusplus 3.3 CONFIG")
set("found_Threads::Threads" "Threads")
set("found_ZLIB::ZLIB" "ZLIB")
set("found_OpenSSL::Crypto" "OpenSSL 3.0 COMPONENTS Crypto")
set("found_OpenEXR::OpenEXR" "OpenEXR 3.1 CONFIG")
set("found_Boost::headers" "Boost 1.74")
set("found_PkgConfig::libdeflate" "pkg-config libdeflate libdeflate")
set("found_PkgConfig::lz4" "pkg-config lz4 liblz4")
set("found_PkgConfig::blosc" "pkg-config blosc blosc")

# Every library outside the project that `target` links, itself or by way of others.
function(spool_outside_libraries target result)
  get_target_property(linked ${target} LINK_LIBRARIES)
  foreach(library ${linked})
    if(library MATCHES "^spool_" AND NOT library STREQUAL "spool_headers")
      spool_outside_libraries(${library} more)
      list(APPEND found ${more})
    elseif(library MATCHES "^[a-zA-Z_]+::")
      list(APPEND found ${library})
    endif()
  endforeach()
  list(REMOVE_DUPLICATES found)
  set(${result} "${found}" PARENT_SCOPE)
endfunction()

set(SPOOL_PACKAGES_OF_COMPONENTS "")
foreach(component ${components})
  spool_outside_libraries(spool_${component} outside)
  set(packages "")
  foreach(library ${outside})
    if(NOT DEFINED "found_${library}")
      message(FATAL_ERROR "cmake/install.cmake: say how ${library}, which spool_${component} links, is found again")
    endif()
    string(APPEND packages "\n  \"${found_${library}}\"")
  endforeach()
  string(APPEND SPOOL_PACKAGES_OF_COMPONENTS "set(_spool_packages_of_${component}${packages})\n")
endforeach()
string(JOIN " " SPOOL_COMPONENT_NAMES ${components})
configure_package_config_file(cmake/spoolConfig.cmake.in ${PROJECT_BINARY_DIR}/spoolConfig.cmake
  INSTALL_DESTINATION lib/cmake/spool NO_SET_AND_CHECK_MACRO)
write_basic_package_version_file(${PROJECT_BINARY_DIR}/spoolConfigVersion.cmake COMPATIBILITY SameMinorVersion)
install(FILES ${PROJECT_BINARY_DIR}/spoolConfig.cmake ${PROJECT_BINARY_DIR}/spoolConfigVersion.cmake
  DESTINATION lib/cmake/spool COMPONENT dev)

list(TRANSFORM libraries PREPEND "-l")
list(REVERSE libraries)
string(JOIN " " SPOOL_LINKED ${libraries})
foreach(name spool spool-formats)
  configure_file(cmake/${name}.pc.in ${PROJECT_BINARY_DIR}/${name}.pc @ONLY)
  install(FILES ${PROJECT_BINARY_DIR}/${name}.pc DESTINATION lib/pkgconfig COMPONENT dev)
endforeach()

# What must be built before `cmake --install` or cpack; the tests are not.
add_custom_target(spool_installed)
foreach(component ${components})
  add_dependencies(spool_installed spool_${component})
endforeach()
foreach(made spool spool_manual)
  if(TARGET ${made})
    add_dependencies(spool_installed ${made})
  endif()
endforeach()
