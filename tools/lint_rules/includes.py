"""Who may include whom: the table of lib/README.md holds for lib/ and formats/, and no two files include each other.

A header and the source of its stem are one file here. So an interface must not share its stem with the list of what
implements it: the list includes every implementation, and each of them includes the interface.
"""

import graphlib
import re
from pathlib import Path

TABLE = Path("lib/README.md")
ROW = re.compile(r"^\| `(?P<room>[\w/]+)` \|.*\| (?P<allowed>[^|]*) \|$", re.M)
INCLUDE = re.compile(r'^#include "((?:lib|formats|tools)/[^"]+)"', re.M)
SOURCES = ("lib/**/*.h", "lib/**/*.cpp", "formats/**/*.h", "formats/**/*.cpp", "tools/**/*.h", "tools/**/*.cpp")


def allowed_rooms():
    """{room: the rooms and single headers that it may include}; rooms as "lib/core", "formats"."""
    return {match["room"]: set(re.findall(r"`([\w/.]+)`", match["allowed"]))
            for match in ROW.finditer(TABLE.read_text(encoding="utf-8"))}


def room_of(path, rooms):
    """The longest room that holds `path`: formats/interchange before formats."""
    holding = [room for room in rooms if path.startswith(room + "/")]
    return max(holding, key=len, default=None)


def stem_of(path):
    return str(Path(path).with_suffix(""))


def read_includes():
    files = sorted({path for pattern in SOURCES for path in Path().glob(pattern)})
    return {path.as_posix(): INCLUDE.findall(path.read_text(encoding="utf-8")) for path in files}


def forbidden(includes, table):
    for path, included in includes.items():
        room = room_of(path, table)
        if room is None:
            if path.startswith(("lib/", "formats/")):
                yield f"{path}: its room is not in the table of {TABLE}"
            continue
        for other in included:
            target = room_of(other, table) or other.split("/")[0]
            if target != room and target not in table[room] and other not in table[room]:
                yield f"{path}: includes {other}, but {room} may not include {target} ({TABLE})"


def circles(includes):
    """The first circle of stems that include each other, as a way from one to the next."""
    graph = {}
    for path, included in includes.items():
        graph.setdefault(stem_of(path), set()).update({stem_of(other) for other in included} - {stem_of(path)})
    try:
        graphlib.TopologicalSorter(graph).prepare()
    except graphlib.CycleError as error:
        first, *way = reversed(error.args[1])
        yield f"{first}: includes itself by way of {', '.join(way[:-1])}"


def check():
    includes = read_includes()
    yield from forbidden(includes, allowed_rooms())
    yield from circles(includes)
