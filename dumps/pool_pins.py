"""What is pinned of a finished recording, and whether a new one agrees with it."""
import hashlib
import os
import platform
import re

PINNED = ("samples_sha256", "bytes", "cpu_seconds", "versions", "processor", "claims")


def processor():
    try:
        with open("/proc/cpuinfo", encoding="utf-8") as stream:
            return re.search(r"model name\s*:\s*(.*)", stream.read())[1].strip()
    except (OSError, TypeError):
        return platform.machine()


def claims(metas):
    """How many claims of dumps/verify hold, fail and are not known, in all of them."""
    found = [finding["holds"] for meta in metas for finding in meta.get("verification", {}).get("findings", [])]
    counts = [(found.count(True), "hold"), (found.count(False), "FAIL"), (found.count(None), "not known")]
    return ", ".join("%d %s" % count for count in counts if count[0]) or "not verified"


def hash_of(paths):
    """Of one recording its content hash, of several that of their hashes."""
    from dumps.verify.content_hash import content_hash
    found = [content_hash(path) for path in paths]
    return found[0] if len(found) == 1 else hashlib.sha256("".join(found).encode()).hexdigest()


def measure(*paths):
    """paths: a recording, or all of one group, which share their reference."""
    import spool
    metas, spp = [], 0
    for path in paths:
        with spool.open(path) as dump:
            metas.append(dump.meta)
            spp, pixels = spp + dump.spp, dump.width * dump.height
    meta = metas[0]
    renderer = meta["renderer"] if isinstance(meta["renderer"], dict) else {
        "name": meta["renderer"], "version": meta.get("version", "")}  # as a folder of passes is packed (dumps/passes.md)
    seconds = round(meta["cost_per_sample"] * pixels * (spp + meta.get("reference", {}).get("samples", 0)))
    version = " ".join(str(renderer[key]) for key in ("name", "version", "variant") if renderer.get(key))
    return {"scene_sha256": meta["scene"]["sha256"], "samples_sha256": hash_of(paths), "bytes": sum(map(os.path.getsize, paths)),
            "cpu_seconds": seconds, "versions": version, "processor": processor(),
            "claims": claims(metas)}


def differences(scene_sha256, pinned, paths):
    """Lines that say what is not as pinned. Other samples on another processor or with another version are none."""
    found = measure(*paths)
    if scene_sha256 not in (None, found["scene_sha256"]):
        return ["another scene than the pinned one (%s, not %s)" % (found["scene_sha256"], scene_sha256)]
    if not pinned:
        return []
    same_tools = all(found[key] == pinned[key] for key in ("versions", "processor"))
    if found["samples_sha256"] != pinned["samples_sha256"] and same_tools:
        llvm = "; they depend on the version of LLVM, too" if "llvm" in found["versions"] else ""
        return ["other samples than the pinned ones (%s, not %s), with the same version on the same kind of processor%s" % (
            found["samples_sha256"], pinned["samples_sha256"], llvm)]
    return []


def pin(path, files):
    """files: {name: recordings}. Replaces or adds the lines `scene_sha256` and `pinned` of each pool, and says what it wrote."""
    with open(path, encoding="utf-8") as stream:
        parts = stream.read().split("[[pool]]\n")
    for name, paths in files.items():
        found = measure(*paths)
        line = 'scene_sha256 = "%s"\n' % found["scene_sha256"] + "pinned = { %s }" % ", ".join("%s = %s" % (key, '"%s"' % found[key] if isinstance(found[key], str) else found[key])
                                            for key in PINNED)
        for i, part in enumerate(parts):
            if part.startswith('name = "%s"\n' % name):
                kept = [text for text in part.split("\n") if not text.startswith(("pinned = ", "scene_sha256 = "))]
                at = max(j for j, text in enumerate(kept) if re.match(r"\w+ = ", text))
                parts[i] = "\n".join([*kept[:at + 1], line, *kept[at + 1:]])
        print("%s: %s" % (name, line))
    with open(path, "w", encoding="utf-8") as stream:
        stream.write("[[pool]]\n".join(parts))
