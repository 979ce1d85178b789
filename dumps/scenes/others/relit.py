"""A scene.xml whose environment picture is not at hand, under an even grey light in its place.

The folder of scene.xml is given with --files; materials, meshes, lamps and camera are the author's. Written for the
scenes tire and chalice of niklassanden/ReSTIR_GI_DR (CC-BY 4.0), which lack textures/*.exr where large files are left out.
"""
import xml.etree.ElementTree as ElementTree

GREY = 0.03  # radiance of the even light
DEPTH = 16
VALUES = {"float": float, "integer": int, "string": str, "boolean": lambda text: text == "true"}


def numbers(text):
    """Of three, or of one three times."""
    found = [float(part) for part in text.replace(",", " ").split()]
    return found * 3 if len(found) == 1 else found


def transform(mi, element):
    total = mi.ScalarTransform4f()
    for step in element:
        if step.tag == "rotate":
            axis = [float(step.get(name, 0)) for name in "xyz"]
            total = mi.ScalarTransform4f().rotate(axis, float(step.get("angle"))) @ total
        elif step.tag == "translate":
            total = mi.ScalarTransform4f().translate(numbers(step.get("value"))) @ total
        else:
            raise ValueError("scene.xml: a transform has <%s>: relit.py knows <rotate> and <translate>" % step.tag)
    return total


def plugin(mi, element):
    """A bsdf, texture, shape, emitter or sensor as the dict that Mitsuba takes."""
    made = {"type": element.get("type")}
    for number, child in enumerate(element):
        name = child.get("name") or child.get("id") or "%s_%d" % (child.tag, number)
        if child.tag in VALUES:
            made[name] = VALUES[child.tag](child.get("value"))
        elif child.tag == "rgb":
            made[name] = {"type": "rgb", "value": numbers(child.get("value"))}
        elif child.tag == "transform":
            made[name] = transform(mi, child)
        elif child.tag == "ref":
            made[name] = {"type": "ref", "id": child.get("id").replace(".", "_")}
        elif child.tag not in ("film", "sampler"):
            made[name] = plugin(mi, child)
    return made


def scene(mi):
    root = ElementTree.parse(str(mi.file_resolver().resolve("scene.xml"))).getroot()
    made = {"type": "scene", "integrator": {"type": "path", "max_depth": DEPTH},
            "light": {"type": "constant", "radiance": {"type": "rgb", "value": [GREY] * 3}}}
    for number, element in enumerate(root):
        if element.tag in ("bsdf", "shape", "sensor"):
            made[(element.get("id") or "%s_%d" % (element.tag, number)).replace(".", "_")] = plugin(mi, element)
    return made
