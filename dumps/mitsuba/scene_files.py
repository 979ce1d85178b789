"""Files that a parsed scene names: are they there, and what is the hash of them all?"""
import hashlib
import os

from dumps.recording.failure import scene_failure


def named_files(mi, state):
    """[(name in the scene, path)] of meshes, textures, volumes and measured data, in the order of the scene."""
    kinds, found = mi.ObjectType, []
    for node in state.nodes:
        if node.type in (kinds.Film, kinds.Sampler, kinds.Integrator):
            continue
        for key in node.props.keys():
            if not key.endswith("filename") or node.props.type(key).name != "String":
                continue
            known = node.props.was_queried(key)
            value = node.props[key]
            node.props.mark_queried(key, known)      # what is read, Mitsuba takes for known: a misspelt name would go unnoticed
            if value not in (name for name, _ in found):
                found.append((value, str(mi.file_resolver().resolve(value))))
    return found


def require(source, files):
    missing = [name for name, path in files if not os.path.isfile(path)]
    if missing:
        more = " and %d more" % (len(missing) - 8) if len(missing) > 8 else ""
        raise scene_failure("%s: %d of the %d files it names %s not there: %s%s: put them beside it, or say where they are with "
                            "--files FOLDER" % (source, len(missing), len(files), "is" if len(missing) == 1 else "are",
                                                ", ".join(missing[:8]), more))


def digest(paths):
    """SHA-256 of the contents of the files, one after the other; of one file, that of the file."""
    total = hashlib.sha256()
    for path in paths:
        if os.path.isfile(path):
            with open(path, "rb") as stream:
                while block := stream.read(1 << 20):
                    total.update(block)
    return total.hexdigest()
