"""Scene files of Mitsuba 0.1 to 0.6, rewritten so that Mitsuba 3 reads them, with a list of what was changed.

Mitsuba 3 renames the properties itself (maxDepth, toWorld, uscale). What it leaves to the user is done here: elements and
plugins that are gone, colours in sRGB, and numbers that mean something else. What has no counterpart and matters (a
subsurface model, a preset medium) is returned as a loss; the caller decides. Other plugins that Mitsuba 3 lacks stay as
they are and are refused by name, unless the user substitutes them.
"""
import os
import xml.etree.ElementTree as ElementTree
from collections import namedtuple

from dumps.mitsuba.old_colours import colours
from dumps.mitsuba.old_media import boundary, medium, numbers
from dumps.recording.failure import io_failure, scene_failure

RENAMED = {"camera": "sensor", "luminaire": "emitter", "lookAt": "lookat"}       # 0.1 to 0.4; 0.5 and 0.6
KNOWN = {"scene", "sensor", "emitter", "lookat", "integrator", "sampler", "film", "rfilter", "bsdf", "texture", "shape",
         "medium", "phase", "volume", "spectrum", "rgb", "srgb", "blackbody", "transform", "translate", "rotate", "scale",
         "matrix", "float", "integer", "boolean", "string", "point", "vector", "ref", "default", "include", "alias", "path",
         "subsurface"}
Rewritten = namedtuple("Rewritten", "text changes lost files")
INTEGRATORS = {"path", "volpath", "volpathmis", "direct"}        # that Mitsuba 3 has, too, and that have samples of a pixel
NEAREST = {("bsdf", "roughdiffuse"): "diffuse", ("bsdf", "ward"): "roughconductor", ("sensor", "perspective_rdist"): "perspective",
           ("film", "ldrfilm"): "hdrfilm", ("film", "mfilm"): "hdrfilm", ("film", "tiledhdrfilm"): "hdrfilm",
           ("film", "exrfilm"): "hdrfilm", ("film", "pngfilm"): "hdrfilm", ("texture", "vertexcolors"): "mesh_attribute"}


def is_old(path):
    """Of an XML file that says a version below 2 (as Mitsuba 3 reads it: none is a broken file, its own error)."""
    try:
        for _, element in ElementTree.iterparse(path, events=("start",)):
            version = element.get("version", "3").split(".")[0]
            return element.tag == "scene" and version.isdigit() and int(version) < 2
    except (ElementTree.ParseError, OSError):
        return False


def rewrite(path, integrator_given=False):
    changes, lost, files = [], [], [os.path.abspath(path)]
    root = _read(path)
    _inline(root, os.path.dirname(files[0]), {files[0]}, files)
    note = lambda text: changes.append(text) if text not in changes else None  # noqa: E731
    _elements(root, note, lost)
    media = any(element.tag == "medium" for element in root.iter())
    for parent in list(root.iter()):
        for element in list(parent):
            colours(parent, element, note)                       # first: media reckon with them
    for parent in root.iter():
        for element in list(parent):
            _plugin(element, note)
            if element.tag == "integrator" and not integrator_given:
                _integrator(element, media, note)
            if element.tag == "medium":
                medium(element, note, lost)
            if element.tag == "shape":
                boundary(element, note)
    return Rewritten(ElementTree.tostring(root, encoding="unicode"), changes, lost, files)


def _read(path):
    try:
        return ElementTree.parse(path, ElementTree.XMLParser(target=ElementTree.TreeBuilder(insert_comments=True))).getroot()
    except ElementTree.ParseError as error:
        raise scene_failure("%s: not XML (%s)" % (path, error))
    except OSError as error:
        raise io_failure("%s: %s: the scene includes it" % (path, error.strerror))


def _inline(parent, folder, above, files):
    """Included files in place of their <include>: Mitsuba would read them as they are."""
    for place, element in reversed(list(enumerate(parent))):
        if element.tag == "include":
            path = os.path.abspath(os.path.join(folder, element.get("filename", "")))
            if path in above:
                raise scene_failure("%s: includes itself" % path)
            content = _read(path)
            files.append(path)
            _inline(content, folder, above | {path}, files)
            parent[place:place + 1] = list(content) if content.tag == "scene" else [content]
        else:
            _inline(element, folder, above, files)


def _elements(parent, note, lost):
    for element in list(parent):
        if not isinstance(element.tag, str):                     # a comment
            continue
        if element.tag in RENAMED:
            element.tag = RENAMED[element.tag]
        if element.tag == "subsurface":
            lost.append("<subsurface type=%s>" % element.get("type"))
            parent.remove(element)
        elif element.tag not in KNOWN:
            note("<%s> left out: Mitsuba 3 has no such element" % element.tag)
            parent.remove(element)
        else:
            _elements(element, note, lost)


def _plugin(element, note):
    plugin = element.get("type")
    nearest = NEAREST.get((element.tag, plugin))
    if nearest:
        if element.tag != "film":                                # films are replaced in any case
            note("%s %s taken as %s, the nearest that Mitsuba 3 has" % (element.tag, plugin, nearest))
        element.set("type", nearest)
    if element.tag == "bsdf" and plugin == "coating":
        inner = element.find("bsdf")
        if inner is not None:
            note("bsdf coating: the coat is dropped, what it covers is kept")
            identity, name = element.get("id"), element.get("name")
            children, kind = list(inner), inner.get("type")
            for child in list(element):
                element.remove(child)
            element.extend(children)
            element.attrib = {key: value for key, value in (("type", kind), ("id", identity), ("name", name)) if value}
    if element.tag == "emitter" and plugin in ("sky", "sun", "sunsky"):
        _sky(element, plugin, note)
    for child in list(element):
        _property(element, child, note)


def _sky(element, plugin, note):
    """Mitsuba 0.6 had y for up in its skies, Mitsuba 3 has z; the direction of the sun is one of the world in both."""
    own = element.find("transform")
    turn = ElementTree.Element("rotate", x="1", y="0", z="0", angle="-90")
    if own is None:
        own = ElementTree.SubElement(element, "transform", name="toWorld")
    own.insert(0, turn)
    note("%s turned so that y is up, as Mitsuba 0.6 had it" % plugin)
    if plugin != "sunsky":
        element.set("type", "sunsky")
        scale = element.find("*[@name='scale']")
        if scale is not None:
            scale.set("name", plugin + "Scale")
        ElementTree.SubElement(element, "float", name="skyScale" if plugin == "sun" else "sunScale", value="0")
        note("emitter %s taken as sunsky without the other part" % plugin)


def _property(element, child, note):
    name, value = child.get("name", ""), child.get("value", "")
    plugin = element.get("type")
    if element.tag == "texture" and name == "uvscale":
        element.remove(child)
        for one in ("uscale", "vscale"):                         # Mitsuba 3 makes a transform of these; each goes before uvscale
            if element.find("*[@name='%s']" % one) is None:
                ElementTree.SubElement(element, child.tag, name=one, value=value)
        note("texture uvscale written as uscale and vscale")
    if element.tag == "texture" and plugin == "bitmap":
        if name == "filterType" and value in ("trilinear", "ewa"):
            child.set("value", "bilinear")
            note("texture filter %s taken as bilinear" % value)
        elif name == "gamma":
            element.remove(child)
            if value.strip() and numbers(value)[0] == 1:
                ElementTree.SubElement(element, "boolean", name="raw", value="true")
                note("texture of gamma 1 taken as raw")
            elif value.strip() and numbers(value)[0] > 0:
                note("texture gamma %s taken as the file's own" % value)
    elif element.tag == "bsdf" and name == "distribution" and value not in ("beckmann", "ggx"):
        child.set("value", "beckmann")
        note("microfacet distribution %s taken as beckmann" % value)


def _integrator(element, media, note):
    plugin, chosen = element.get("type"), "volpath" if media else "path"
    if plugin not in INTEGRATORS:
        for child in list(element):
            if child.get("name") not in ("maxDepth", "rrDepth", "hideEmitters"):
                element.remove(child)
        element.set("type", chosen)
        note("integrator %s taken as %s" % (plugin, chosen))
    for child in list(element):
        if child.get("name") == "strictNormals":
            element.remove(child)
            note("strictNormals dropped: Mitsuba 3 always traces shading normals as they are")
