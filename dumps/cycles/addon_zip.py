#!/usr/bin/env python3
"""Makes the add-on as one file that Blender installs: the panel and the recorder it starts.

    python3 dumps/cycles/addon_zip.py -o spool_recorder.zip

With its licence, and an SPDX list that says that it contains nothing of others. The same tree gives the same bytes. Blender 3.4 to 4.1: Preferences, Add-ons, Install; from 4.2 on the file is
an extension: Preferences, Get Extensions, Install from Disk.
"""
import argparse
import glob
import os
import subprocess
import sys
import tempfile
import zipfile

HERE = os.path.dirname(os.path.abspath(__file__))
BUNDLED = os.path.join(HERE, "..", "..", "tools", "package", "bundled.py")
NAME = "spool_recorder"


def members():
    """[(path in the zip file, bytes)], sorted."""
    addon = os.path.join(HERE, "addon")
    found = [("", p) for p in glob.glob(os.path.join(addon, "*.py")) + [os.path.join(addon, "blender_manifest.toml")]]
    found += [("recorder/dumps/cycles/", p) for p in glob.glob(os.path.join(HERE, "*.py")) if p != os.path.abspath(__file__)]
    found += [("recorder/dumps/recording/", p) for p in glob.glob(os.path.join(HERE, "..", "recording", "*.py"))]
    found += [("recorder/dumps/", os.path.join(HERE, "..", "__init__.py"))]
    made = []
    for folder, path in found:
        with open(path, "rb") as stream:
            made.append(("%s/%s%s" % (NAME, folder, os.path.basename(path)), stream.read()))
    return sorted(made)


def licences():
    """[(path in the zip file, bytes)]: nothing is compiled in, and nothing of others is copied."""
    with tempfile.TemporaryDirectory() as folder:
        subprocess.run([sys.executable, BUNDLED, "build", folder, folder, "--name", NAME], check=True)
        made = []
        for name, file in (("LICENSE", "copyright"), (NAME + ".spdx.json",) * 2):
            with open(os.path.join(folder, file), "rb") as stream:
                made.append(("%s/%s" % (NAME, name), stream.read()))
    return made


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("-o", "--out", default=NAME + ".zip")
    options = parser.parse_args()
    try:
        with zipfile.ZipFile(options.out, "w", zipfile.ZIP_DEFLATED) as archive:
            for name, data in members() + licences():
                entry = zipfile.ZipInfo(name, (2000, 1, 1, 0, 0, 0))
                entry.compress_type, entry.external_attr = zipfile.ZIP_DEFLATED, 0o644 << 16
                archive.writestr(entry, data)
    except OSError as error:
        print("%s: %s" % (error.filename or options.out, error.strerror), file=sys.stderr)
        return 3
    print(options.out)
    return 0


if __name__ == "__main__":
    sys.exit(main())
