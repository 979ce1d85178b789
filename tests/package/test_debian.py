"""The .deb packages: made by cpack, unpacked into an empty root by dpkg, removed, and nothing is left."""
import os
import shutil
import subprocess

import pytest
from conftest import BUILD, CMAKE, run

PACKAGES = {"spool", "spool-png", "libspool-dev", "python3-spool"}


@pytest.fixture(scope="module")
def packages(tmp_path_factory):
    """{name: file}"""
    missing = [tool for tool in ("dpkg-deb", "dpkg-shlibdeps", "file") if not shutil.which(tool)]
    if missing:
        pytest.skip("apt-get install dpkg-dev file: no " + ", ".join(missing))
    folder = tmp_path_factory.mktemp("packages")
    cpack = os.path.join(os.path.dirname(shutil.which(CMAKE)), "cpack")
    run(cpack, "--config", BUILD / "CPackConfig.cmake", "-B", folder, folder=folder)
    return {file.name.split("_")[0]: file for file in folder.glob("*.deb")}


def field(file, name):
    return run("dpkg-deb", "--field", file, name).strip()


def test_there_are_four_of_the_project_s_version(packages):
    assert set(packages) == PACKAGES
    assert {field(file, "Version") for file in packages.values()} == {os.environ["SPOOL_VERSION"]}


def test_only_the_png_package_needs_openimageio(packages):
    assert "libopenimageio" in field(packages["spool-png"], "Depends")
    needs = field(packages["spool"], "Depends")
    assert "libopenimageio" not in needs and "libopenexr" in needs and "libtbb12" in needs and "python3-numpy" in needs


def test_headers_and_libraries_come_with_what_they_include(packages):
    files = run("dpkg-deb", "--contents", packages["libspool-dev"])
    assert "./usr/include/spool/lib/core/image.h" in files and "./usr/lib/cmake/spool/spoolConfig.cmake" in files
    assert "./usr/bin" not in files


def test_each_carries_its_licences_and_its_list(packages):
    for name, file in packages.items():
        files = run("dpkg-deb", "--contents", file)
        assert f"./usr/share/doc/{name}/copyright\n" in files and f"./usr/share/doc/{name}/{name}.spdx.json\n" in files


def test_no_file_is_in_two_packages(packages):
    seen = {}
    for name, file in packages.items():
        for line in run("dpkg-deb", "--contents", file).splitlines():
            path = line.split(None, 5)[5]
            if not path.endswith("/"):
                assert path not in seen, (path, name, seen[path])
                seen[path] = name


def test_unpacked_and_removed_nothing_is_left(packages, tmp_path):
    root = tmp_path / "root"
    database = root / "var/lib/dpkg"
    for part in ("info", "updates", "triggers"):
        (database / part).mkdir(parents=True)
    for part in ("status", "available"):
        (database / part).touch()
    dpkg = ["dpkg", "--root", root, "--force-depends", "--force-not-root", "--force-script-chrootless",
            "--log", tmp_path / "dpkg.log"]
    run(*dpkg, "--install", *packages.values())
    assert (root / "usr/bin/spool").is_file()
    for compiled in ("share/spool/tools/report", "lib/python3/dist-packages/spool"):  # as a run by root leaves it
        (root / "usr" / compiled / "__pycache__").mkdir()
        (root / "usr" / compiled / "__pycache__/x.pyc").touch()
    run(*dpkg, "--purge", *packages)
    left = [path for path in root.rglob("*") if path.is_file() and database not in path.parents]
    assert left == []
    assert subprocess.run(["find", str(root), "-name", "*spool*"], capture_output=True, text=True,
                          check=True).stdout == ""
