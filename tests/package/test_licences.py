"""What is installed names what it contains of others, with the texts, as SPDX 2.3."""
import json
import re
import zipfile
from pathlib import Path

import pytest
from conftest import TREE, run

COMMAND = ["python3", TREE / "tools/package/bundled.py"]


def checked(folder, name):
    """The list and the texts in a folder, as the SPDX specification wants a list; {package: version}."""
    listed = json.loads((folder / f"{name}.spdx.json").read_text(encoding="utf-8"))
    assert listed["spdxVersion"] == "SPDX-2.3" and listed["dataLicense"] == "CC0-1.0" and listed["SPDXID"] == "SPDXRef-DOCUMENT"
    assert re.fullmatch(r"\d{4}-\d\d-\d\dT\d\d:\d\d:\d\dZ", listed["creationInfo"]["created"])
    identities = {one["SPDXID"]: one for one in listed["packages"]}
    assert len(identities) == len(listed["packages"])
    assert all(re.fullmatch(r"SPDXRef-[A-Za-z0-9.-]+", one) for one in identities)
    own = [one["relatedSpdxElement"] for one in listed["relationships"] if one["relationshipType"] == "DESCRIBES"]
    contained = {one["relatedSpdxElement"] for one in listed["relationships"]
                 if one["relationshipType"] == "CONTAINS" and [one["spdxElementId"]] == own}
    assert contained | set(own) == set(identities)
    texts = {one["licenseId"]: one["extractedText"] for one in listed["hasExtractedLicensingInfos"]}
    copyright_text = (folder / "copyright").read_text(encoding="utf-8")
    assert (TREE / "LICENSE").read_text(encoding="utf-8") in copyright_text
    for identity in contained:
        text = texts[identities[identity]["licenseDeclared"]]
        assert len(text) > 100 and text.strip() in copyright_text
        for common in re.findall(r"/usr/share/common-licenses/([\w-]+(?:\.\d+)*)", text):
            assert f"The licence {common}\n" in copyright_text or not Path("/usr/share/common-licenses", common).exists(), common
    return {identities[one]["name"]: identities[one]["versionInfo"] for one in contained}


def test_what_is_installed(prefix):
    found = {name: checked(prefix / "share/doc" / name, name) for name in ("spool", "spool-png", "libspool-dev")}
    assert {"plotly.js-basic-dist-min", "tablesort"} <= set(found["spool"])
    assert {"fmtlib", "onetbb", "openexr", "nlohmann-json3", "tl-expected", "tomlplusplus", "boost1.74", "cli11"} <= set(found["spool"])
    assert not {"nanobind", "openimageio", "glibc", "gcc-12", "googletest"} & set(found["spool"])  # of the modules, the system, the tests
    assert {"onetbb", "boost1.74"} <= set(found["libspool-dev"]) and not {"plotly.js-basic-dist-min", "cli11"} & set(found["libspool-dev"])
    assert "openimageio" in found["spool-png"] and "onetbb" not in found["spool-png"]
    beast = (prefix / "share/doc/spool/copyright").read_text(encoding="utf-8")
    assert "Vinnie Falco" in beast and "Boost Software License" in beast


def test_the_add_on(tmp_path):
    archive = tmp_path / "addon.zip"
    run("python3", TREE / "dumps/cycles/addon_zip.py", "-o", archive)
    with zipfile.ZipFile(archive) as opened:
        for name in ("LICENSE", "spool_recorder.spdx.json"):
            (tmp_path / name.replace("LICENSE", "copyright")).write_bytes(opened.read("spool_recorder/" + name))
    assert checked(tmp_path, "spool_recorder") == {}


@pytest.fixture
def wheel(prefix, tmp_path):
    """An unpacked wheel, as auditwheel leaves it."""
    root = tmp_path / "wheel"
    for folder in ("spool_lab-1.dist-info/licenses", "spool_lab.libs", "spool/share/doc/spool"):
        (root / folder).mkdir(parents=True)
    for name in ("copyright", "spool.spdx.json"):
        (root / "spool/share/doc/spool" / name).write_bytes((prefix / "share/doc/spool" / name).read_bytes())
    return root


def add(root):
    return run("python3", "-c", f"import sys, pathlib; sys.path[:0] = [{str(COMMAND[1].parent)!r}]; import bundled; "
               f"bundled.add_libraries(pathlib.Path({str(root)!r}))")


def test_a_wheel_names_the_libraries_copied_into_it(wheel, prefix):
    whole = Path("/usr/lib/x86_64-linux-gnu/libIex-3_1.so").resolve().name.replace(".so", "-9cd2a3ad.so")  # as newer auditwheels name it
    for name in ("libz-3f2a1b4c.so.1", "libOpenEXR-3_1-0a1b2c3d.so.30", "libdeflate-deadbeef.so.0", whole):
        (wheel / "spool_lab.libs" / name).touch()
    add(wheel)
    notes = wheel / "spool_lab-1.dist-info"
    (notes / "copyright").write_bytes((notes / "licenses/copyright").read_bytes())
    (notes / "spool.spdx.json").write_bytes((notes / "sboms/spool.spdx.json").read_bytes())
    found = checked(notes, "spool")
    assert {"zlib", "openexr", "libdeflate", "tablesort", "boost1.74"} <= set(found)
    assert set(checked(prefix / "share/doc/spool", "spool")) <= set(found)


def test_a_library_that_nobody_knows_is_no_part_of_a_wheel(wheel):
    (wheel / "spool_lab.libs/libunheard-3f2a1b4c.so.1").touch()
    with pytest.raises(AssertionError, match="libunheard"):
        add(wheel)
