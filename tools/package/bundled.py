#!/usr/bin/env python3
"""Says what a package of Spool carries of others: `copyright`, the licence texts, and `spool.spdx.json`, an SPDX 2.3 list.

    python3 tools/package/bundled.py build BUILD FOLDER --of lib formats tools    what is compiled in; cmake --install runs it
    python3 tools/package/bundled.py wheel WHEEL                                  adds the libraries that auditwheel copied

Headers are those that ninja noted for the objects of the folders named; Debian's package of each gives version and
texts, a Python package its own. What the system brings itself - C library, compiler - is loaded and not carried.
"""
import argparse
import fnmatch
import json
import os
import re
import subprocess
import sys
from pathlib import Path
from typing import NamedTuple

TREE = Path(__file__).resolve().parents[2]
OF_THE_SYSTEM = re.compile(r"(glibc|linux|gcc-\d+|llvm-toolchain-\d+|libxcrypt)$")
COMMON = Path("/usr/share/common-licenses")


class Part(NamedTuple):
    name: str
    version: str
    place: str  # a package URL
    text: str  # the licence, as its authors or its packagers wrote it


def output_of(*words):
    return subprocess.run(words, capture_output=True, text=True, check=False).stdout


def headers_of(build, folders, without):
    """Headers outside the tree that objects of these folders were made with."""
    ours, used, found = (str(TREE) + "/", str(build) + "/"), False, set()
    wanted, unwanted = [tuple(folder + "/" for folder in some) for some in (folders, without)]
    for line in output_of("ninja", "-n", "-C", str(build), "-t", "deps").splitlines():
        if not line.startswith(" "):
            used = line.startswith(wanted) and not line.startswith(unwanted) and "(VALID)" in line
        elif used and line.strip() and not (path := os.path.realpath(build / line.strip())).startswith(ours):
            found.add(path)
    return sorted(found)


def packages_of(files):
    """{Debian's source package and version: (a binary package, its files)}, and the files that no package holds."""
    held, left = {}, set(files)
    # /lib is a link to /usr/lib, and some packages list their files below /lib.
    named = {name: path for path in files for name in (path, path.removeprefix("/usr"))}
    names = sorted(named)
    for start in range(0, len(names), 500):
        for line in output_of("dpkg-query", "-S", *names[start:start + 500]).splitlines():
            package, _, name = line.partition(": ")
            if (path := named.get(name)) in left:
                held.setdefault(package.split(",")[0], []).append(path)
                left.discard(path)
    found = {}
    for package, paths in held.items():
        source = output_of("dpkg-query", "-W", "-f", "${source:Package} ${source:Version}", package)
        found.setdefault(tuple(source.split()), (package.partition(":")[0], []))[1].extend(paths)
    return found, left


def used_of(text, headers):
    """Of a list of files and licences as long as Boost's: what concerns these headers."""
    if len(text) < 100_000:
        return text
    paths = [path.rpartition("/include/")[2] for path in headers]
    sources = [f"libs/{re.split('[/.]', path)[1]}/include/{path}" for path in paths]
    rooms = {source.split("/")[1] for source in sources}

    def concerns(patterns):
        near = [pattern for pattern in patterns if pattern == "*" or (pattern.split("/") + [""])[1] in rooms]
        return any(fnmatch.filter(sources, pattern) for pattern in near)
    kept = []
    for paragraph in re.split(r"\n\s*\n", text):
        files = re.match(r"Files:(.*?)^\w", paragraph, re.S | re.M)
        if not files or concerns(files[1].split()):
            kept.append(paragraph)
    return "\n\n".join(kept)


def debian_parts(files):
    """What Debian's packages of these files are, and files that are of none."""
    packages, left = packages_of(files)
    parts = []
    for (source, version), (package, paths) in packages.items():
        if OF_THE_SYSTEM.match(source):
            continue
        text = (Path("/usr/share/doc") / package / "copyright").read_text(encoding="utf-8", errors="replace")
        parts.append(Part(source, version, f"pkg:deb/debian/{source}@{version}?arch=source", used_of(text, paths)))
    return parts, left


def python_parts(files):
    """Headers of a Python package (nanobind), and what it brings of others itself."""
    parts, left = {}, set()
    for path in files:
        inside = re.match(r"(.*/site-packages)/(\w+)/(?:ext/(\w+)/)?", path)
        notes = sorted(Path(inside[1]).glob(f"{inside[2]}-*.dist-info")) if inside else []
        if not notes:
            left.add(path)
        elif inside[3]:  # its headers begin with their licence
            text = re.match(r"/\*\*.*?\*/", Path(path).read_text(encoding="utf-8"), re.S)
            parts[inside[3]] = Part(inside[3], "", f"pkg:generic/{inside[3]}", text[0])
        else:
            name, _, version = notes[0].stem.partition("-")
            texts = sorted([*notes[0].glob("LICEN*"), *notes[0].glob("licenses/*")])
            parts[name] = Part(name, version, f"pkg:pypi/{name}@{version}", "\n".join(text.read_text(encoding="utf-8") for text in texts))
    return list(parts.values()), left


def script_parts():
    """The scripts of the report, with the licences that were fetched with them."""
    cache = os.environ.get("SPOOL_REPORT_ASSETS") or Path(os.environ.get("XDG_CACHE_HOME") or Path.home() / ".cache") / "spool/report-assets"
    fetched = (TREE / "tools/report/fetch_assets.sh").read_text(encoding="utf-8")
    return [Part(name, version, f"pkg:npm/{name}@{version}", (Path(cache) / licence).read_text(encoding="utf-8"))
            for name, version, licence in re.findall(r"tar -xzOf (\S+?)-(\d[\d.]*)\.tgz package/LICEN\S+ >assets/(\S+)", fetched)
            if (Path(cache) / licence).exists()]


def with_common(texts):
    """What these name of Debian's common licences, {name: text}."""
    named = {name.rstrip(".") for text in texts for name in re.findall(r"common-licenses/([\w.-]+)", text)}
    return {name: (COMMON / name).read_text(encoding="utf-8") for name in sorted(named) if (COMMON / name).exists()}


def spdx_id(text):
    return re.sub(r"[^A-Za-z0-9.-]", "-", text)


def document(name, version, parts):
    """An SPDX 2.3 document: the package `name`, and what it contains. The same parts give the same bytes."""
    def entry(part, licence):
        return {"SPDXID": f"SPDXRef-{spdx_id(part.name)}", "name": part.name, "versionInfo": part.version or "NOASSERTION",
                "downloadLocation": "NOASSERTION", "filesAnalyzed": False, "licenseConcluded": "NOASSERTION",
                "licenseDeclared": licence, "copyrightText": "NOASSERTION",
                "externalRefs": [{"referenceCategory": "PACKAGE-MANAGER", "referenceType": "purl", "referenceLocator": part.place}]}
    own = entry(Part(name, version, f"pkg:generic/{name}@{version}", ""), "MIT")
    others = [entry(part, f"LicenseRef-{spdx_id(part.name)}") for part in parts]
    describes = [{"spdxElementId": "SPDXRef-DOCUMENT", "relationshipType": "DESCRIBES", "relatedSpdxElement": own["SPDXID"]}]
    return {"spdxVersion": "SPDX-2.3", "dataLicense": "CC0-1.0", "SPDXID": "SPDXRef-DOCUMENT", "name": f"{name}-{version}",
            "documentNamespace": f"https://spdx.org/spdxdocs/{name}-{version}",
            "creationInfo": {"created": "2000-01-01T00:00:00Z", "creators": [f"Tool: {name}-bundled"]},
            "packages": [own, *others],
            "relationships": describes + [{"spdxElementId": own["SPDXID"], "relationshipType": "CONTAINS",
                                           "relatedSpdxElement": other["SPDXID"]} for other in others],
            "hasExtractedLicensingInfos": [{"licenseId": f"LicenseRef-{spdx_id(part.name)}", "name": part.name,
                                            "extractedText": part.text} for part in parts]}


def parts_of(listed):
    """Of a document, what document() made it from."""
    texts = {one["licenseId"]: one["extractedText"] for one in listed["hasExtractedLicensingInfos"]}
    return [Part(one["name"], one["versionInfo"], one["externalRefs"][0]["referenceLocator"], texts[one["licenseDeclared"]])
            for one in listed["packages"] if one["licenseDeclared"] in texts]


def copyright_text(name, parts):
    """All texts, one after the other."""
    own = (TREE / "LICENSE").read_text(encoding="utf-8")
    sections = [(f"{part.name} {part.version}".strip(), part.text) for part in parts]
    sections += [(f"The licence {common}", text) for common, text in with_common(part.text for part in parts).items()]
    named = "".join(f"  {part.name} {part.version}\n" for part in parts)
    head = f"{name}\n\n{own}" + (f"\nIt contains code of these, whose licences follow:\n\n{named}" if parts else "")
    return head + "".join(f"\n{'=' * 80}\n{title}\n{'=' * 80}\n\n{text.strip()}\n" for title, text in sections)


def write(folder, name, version, parts):
    parts = sorted({part.name: part for part in parts}.values())
    folder.mkdir(parents=True, exist_ok=True)
    (folder / "copyright").write_text(copyright_text(name, parts), encoding="utf-8")
    listed = json.dumps(document(name, version, parts), indent=1)
    (folder / f"{name}.spdx.json").write_text(listed + "\n", encoding="utf-8")


def of_build(build, folder, folders, without, scripts, name):
    version = re.search(r"^project\(spool VERSION ([\d.]+)", (TREE / "CMakeLists.txt").read_text(encoding="utf-8"), re.M)[1]
    found, left = debian_parts(headers_of(build, folders, without)) if folders else ([], ())
    more, left = python_parts(sorted(left))
    if left:
        print(f"{folder}: its list lacks what no package holds: {', '.join(sorted(left)[:3])}", file=sys.stderr)
    write(folder, name, version, found + more + (script_parts() if scripts else []))


def add_libraries(root):
    """Adds the libraries in NAME.libs, and puts list and texts where a wheel has them (PEP 639, PEP 770)."""
    kept = root / "spool/share/doc/spool"
    listed = json.loads((kept / "spool.spdx.json").read_text(encoding="utf-8"))
    known = {words[0]: words[-1] for words in map(str.split, output_of("/sbin/ldconfig", "-p").splitlines()) if "=>" in words}
    known = {os.path.basename(os.path.realpath(path)): path for path in known.values()} | known  # libz.so.1.2.13, libz.so.1
    files = []
    for library in sorted(root.glob("*.libs/*")):
        name = re.sub(r"-[0-9a-f]{8}(?=[.-])", "", library.name)  # auditwheel's mark
        if name not in known:
            sys.exit(f"{library.name}: no library of this machine is called {name}")
        files.append(os.path.realpath(known[name]))
    more, left = debian_parts(files)
    if left:
        sys.exit(f"no package holds {', '.join(sorted(left))}")
    notes, = root.glob("*.dist-info")
    write(kept, "spool", listed["packages"][0]["versionInfo"], [*parts_of(listed), *more])
    for file, room in (("copyright", "licenses"), ("spool.spdx.json", "sboms")):
        (notes / room).mkdir(exist_ok=True)
        (kept / file).rename(notes / room / file)
    kept.rmdir()


def of_wheel(wheel):
    from auditwheel.wheeltools import InWheelCtx  # writes RECORD anew
    with InWheelCtx(wheel, wheel) as inside:
        add_libraries(Path(inside.path))


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    kinds = parser.add_subparsers(dest="kind", required=True)
    build = kinds.add_parser("build")
    build.add_argument("build", type=Path)
    build.add_argument("folder", type=Path)
    build.add_argument("--of", nargs="*", default=[], help="folders of the tree whose objects count")
    build.add_argument("--without", nargs="*", default=[], help="and those of them that do not")
    build.add_argument("--name", default="spool")
    build.add_argument("--scripts", action="store_true", help="with the scripts of the report")
    wheel = kinds.add_parser("wheel")
    wheel.add_argument("wheel", type=Path)
    options = parser.parse_args()
    if options.kind == "wheel":
        of_wheel(options.wheel)
    else:
        of_build(options.build.resolve(), options.folder, options.of, options.without, options.scripts, options.name)


if __name__ == "__main__":
    main()
