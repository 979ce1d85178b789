"""Programs of others against the installed package: find_package, pkg-config, and add_subdirectory."""
import os
import shlex

import numpy as np
import pytest
from conftest import CMAKE, TREE, configure, run

from spool import exr

CHESS = TREE / "dumps/tiny/chess.spool"
EXAMPLE = TREE / "docs/examples"

EVERY_COMPONENT = """
cmake_minimum_required(VERSION 3.25)
project(every_component LANGUAGES CXX)
find_package(spool 0.1 REQUIRED)
get_directory_property(targets IMPORTED_TARGETS)
foreach(target ${targets})
  if(target MATCHES "^spool::" AND NOT target STREQUAL "spool::spool_headers")
    string(REPLACE "spool::" "with_" name ${target})
    file(WRITE ${CMAKE_BINARY_DIR}/main.cpp "int main() {}")
    add_executable(${name} ${CMAKE_BINARY_DIR}/main.cpp)
    target_link_libraries(${name} PRIVATE -Wl,--whole-archive $<TARGET_FILE:${target}> -Wl,--no-whole-archive ${target})
  endif()
endforeach()
"""

FORMATS_ALONE = """
cmake_minimum_required(VERSION 3.25)
project(formats_alone LANGUAGES CXX)
find_package(spool {version} REQUIRED COMPONENTS {components})
add_executable(reader reader.cpp)
target_link_libraries(reader PRIVATE spool::formats)
"""

READER = """
#include <cstdio>
#include "formats/spool_reader.h"
int main(int, char** arguments) {
  const auto reader = spool::format::SpoolReader::open(arguments[1]);
  if (!reader) return 1;
  std::printf("%u\\n", static_cast<unsigned>(reader->header().width));
}
"""


def same_image_as_the_program(prefix, image, folder):
    """The bytes of every pixel; the program's file says beside them which filter it was."""
    spool = prefix / "bin/spool"
    run(spool, "replay", CHESS, "--sampler", "multiscale", "--spp", "8", "-o", "selection.exr", folder=folder)
    run(spool, "reconstruct", CHESS, "--selection", "selection.exr", "--filter", "directional", "-o", "expected.exr",
        folder=folder)
    expected, made = exr.read(str(folder / "expected.exr")), exr.read(str(image))
    assert set(made) == set(expected) == {"R", "G", "B"}
    for channel, plane in expected.items():
        assert np.asarray(made[channel]).tobytes() == np.asarray(plane).tobytes()


def test_the_example_makes_the_bytes_of_the_program(prefix, tmp_path):
    configure(EXAMPLE, tmp_path / "build", f"-DCMAKE_PREFIX_PATH={prefix}")
    run(CMAKE, "--build", tmp_path / "build")
    said = run(tmp_path / "build/replay_and_reconstruct", CHESS, tmp_path / "image.exr")
    assert said == "32768 samples taken\n"
    same_image_as_the_program(prefix, tmp_path / "image.exr", tmp_path)
    code = (EXAMPLE / "replay_and_reconstruct.cpp").read_text(encoding="utf-8")
    lines = [line for line in code.splitlines() if line.strip() and not line.startswith("//")]
    assert len(lines) <= 25, "it is shown as a short program"
    assert code in (TREE / "docs/cpp_package.md").read_text(encoding="utf-8"), "docs/cpp_package.md shows another program"


def test_the_example_by_pkg_config(prefix, tmp_path):
    path = {"PKG_CONFIG_PATH": str(prefix / "lib/pkgconfig")}
    flags = shlex.split(run("pkg-config", "--cflags", "--libs", "spool", **path))
    compiler = [os.environ["CXX"], *shlex.split(os.environ.get("SPOOL_CXX_FLAGS", "")), "-std=c++20"]
    run(*compiler, EXAMPLE / "replay_and_reconstruct.cpp", *flags, "-o", tmp_path / "program")
    run(tmp_path / "program", CHESS, tmp_path / "image.exr")
    same_image_as_the_program(prefix, tmp_path / "image.exr", tmp_path)
    assert run("pkg-config", "--modversion", "spool", **path).strip() == os.environ["SPOOL_VERSION"]


def test_every_component_links_whole(prefix, tmp_path):
    (tmp_path / "CMakeLists.txt").write_text(EVERY_COMPONENT, encoding="utf-8")
    configure(tmp_path, tmp_path / "build", f"-DCMAKE_PREFIX_PATH={prefix}")
    run(CMAKE, "--build", tmp_path / "build")
    made = {path.name for path in (tmp_path / "build").glob("with_*")}
    assert {"with_formats", "with_core", "with_pool", "with_sampling", "with_filters", "with_metrics", "with_inference",
            "with_experiment", "with_recording"} <= made


def formats_alone(tmp_path, version="0.1", components="formats"):
    source = tmp_path / "source"
    source.mkdir()
    (source / "CMakeLists.txt").write_text(FORMATS_ALONE.format(version=version, components=components),
                                           encoding="utf-8")
    (source / "reader.cpp").write_text(READER, encoding="utf-8")
    return source


def test_formats_alone_look_for_no_image_library(prefix, tmp_path):
    absent = [f"-DCMAKE_DISABLE_FIND_PACKAGE_{name}=TRUE" for name in ("OpenEXR", "TBB", "Boost", "OpenSSL")]
    configure(formats_alone(tmp_path), tmp_path / "build", f"-DCMAKE_PREFIX_PATH={prefix}", *absent)
    run(CMAKE, "--build", tmp_path / "build")
    assert run(tmp_path / "build/reader", CHESS) == "64\n"


@pytest.mark.parametrize("asked, complaint", [
    ({"components": "formats telepathy"}, "telepathy"),
    ({"version": "0.2"}, "0.2"),
])
def test_what_is_not_there_is_refused_by_its_name(prefix, tmp_path, asked, complaint):
    with pytest.raises(AssertionError, match=complaint):
        configure(formats_alone(tmp_path, **asked), tmp_path / "build", f"-DCMAKE_PREFIX_PATH={prefix}")


def test_as_a_subdirectory_without_what_tests_and_program_need(tmp_path):
    (tmp_path / "CMakeLists.txt").write_text(f"""
cmake_minimum_required(VERSION 3.25)
project(outer LANGUAGES CXX)
add_subdirectory({TREE} spool)
add_executable(hint hint.cpp)
target_link_libraries(hint PRIVATE spool::core)
""", encoding="utf-8")
    (tmp_path / "hint.cpp").write_text("""
#include <cstdio>
#include "lib/core/nearest_name.h"
int main() { std::puts(spool::unknown_name("filter", "boxx", {"box"}).c_str()); }
""", encoding="utf-8")
    absent = [f"-DCMAKE_DISABLE_FIND_PACKAGE_{name}=TRUE" for name in ("GTest", "rapidcheck", "CLI11", "OpenImageIO")]
    configure(tmp_path, tmp_path / "build", *absent)
    run(CMAKE, "--build", tmp_path / "build", "--target", "hint")
    assert "'box'" in run(tmp_path / "build/hint")
    targets = run("ninja", "-C", tmp_path / "build", "-t", "targets", "all")
    assert "libspool_filters.a" in targets
    assert "test_core" not in targets and "spool_png" not in targets and "main.cpp" not in targets
