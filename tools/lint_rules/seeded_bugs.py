"""Every seeded bug of tests/mutation applies to the code as it is, and says which tests are to notice it.

The code moves on; a bug whose text is gone would be a test of the tests that never runs.
"""

from pathlib import Path

import tomllib

LIST = Path("tests/mutation/mutations.toml")


def check():
    for bug in tomllib.loads(LIST.read_text(encoding="utf-8"))["mutation"]:
        path = Path(bug["file"])
        found = path.read_text(encoding="utf-8").count(bug["old"]) if path.is_file() else 0
        if found != 1:
            yield f"{LIST}: {bug['id']}: its text stands {found} times in {bug['file']}"
        if not bug.get("tests"):
            yield f"{LIST}: {bug['id']}: names no tests that are to notice it"
