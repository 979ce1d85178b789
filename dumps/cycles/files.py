"""Files that a .blend file names: what is not there is listed before anything is rendered. Cycles itself goes on, with magenta
for a texture and nothing for a library, a cache or a volume."""
import os

import bpy

from dumps.recording.failure import scene_failure, usage_failure

# Who uses an image or a texture in a picture. Camera backgrounds, brushes and the compositor do not show in one.
SHOWS = (bpy.types.Material, bpy.types.World, bpy.types.Light, bpy.types.Texture, bpy.types.NodeTree)


def named_files():
    """[(kind, path as the file has it, absolute paths, owner)] of what the picture may need."""
    found = []
    users = bpy.data.user_map(subset=list(bpy.data.images))
    for image in bpy.data.images:
        if image.source in ("FILE", "SEQUENCE", "MOVIE", "TILED") and not image.packed_file and not len(image.packed_files) and any(
                isinstance(user, SHOWS) and user.bl_rna.identifier != "CompositorNodeTree" for user in users.get(image, ())):
            found.append(("texture", image.filepath, _tiles(image), image))
    for font in bpy.data.fonts:
        if font.filepath != "<builtin>" and not font.packed_file and font.users:
            found.append(("font", font.filepath, [_absolute(font, font.filepath)], font))
    for kind, owners in (("library", bpy.data.libraries), ("cache", bpy.data.cache_files), ("volume", bpy.data.volumes)):
        found += [(kind, owner.filepath, [_absolute(owner, owner.filepath)], owner) for owner in owners
                  if owner.users and owner.filepath and not getattr(owner, "packed_file", None)]
    return found + _of_nodes() + _of_simulations()


def _tiles(image):
    path = _absolute(image, image.filepath)
    return [path.replace("<UDIM>", str(tile.number)) for tile in image.tiles] if image.source == "TILED" else [path]


def _of_nodes():
    """Light profiles and shader scripts."""
    trees = [owner.node_tree for owners in (bpy.data.materials, bpy.data.worlds, bpy.data.lights) for owner in owners
             if owner.node_tree and owner.users] + [tree for tree in bpy.data.node_groups if tree.users]
    return [("light profile" if node.type == "TEX_IES" else "shader script", node.filepath, [_absolute(node.id_data, node.filepath)], node)
            for tree in trees for node in tree.nodes
            if node.type in ("TEX_IES", "SCRIPT") and node.mode == "EXTERNAL" and node.filepath]


def _of_simulations():
    found = []
    for item in bpy.data.objects:
        for modifier in item.modifiers:
            settings = getattr(modifier, "domain_settings", None)
            if modifier.type == "FLUID" and modifier.fluid_type == "DOMAIN" and settings and modifier.show_render:
                found.append(("cache", settings.cache_directory, [_absolute(item, settings.cache_directory)], settings))
            if modifier.type in ("MESH_CACHE", "OCEAN") and modifier.show_render and modifier.filepath and (
                    modifier.type == "MESH_CACHE" or modifier.is_cached):
                found.append(("cache", modifier.filepath, [_absolute(item, modifier.filepath)], modifier))
    return found


def _absolute(owner, path):
    return bpy.path.abspath(path, library=getattr(owner, "library", None))


def substitute(substitutes):
    """Puts other files in the place of named ones, by name or by path; lines to print."""
    lines = []
    for name, path in substitutes.items():
        if not os.path.exists(path):
            raise usage_failure("--substitute %s=%s: no such file" % (name, path))
        owners = [(kind, owner) for kind, named, _, owner in named_files() if name in (named, os.path.basename(named.rstrip("/\\")),
                                                                                       named.replace("\\", "/").rpartition("/")[2])]
        if not owners:
            raise usage_failure("--substitute %s: the scene names no such file" % name)
        for kind, owner in owners:
            if kind == "font":
                owner.user_remap(bpy.data.fonts.load(os.path.abspath(path)))
            else:
                setattr(owner, "cache_directory" if hasattr(owner, "cache_directory") else "filepath", os.path.abspath(path))
            if hasattr(owner, "reload") and kind != "font":
                owner.reload()
        lines.append("%s replaced by %s, as asked" % (name, os.path.basename(path)))
    return lines


def require(scene_name):
    """Refuses a scene of which a file is not there or holds no image."""
    named = named_files()
    lost = ["%s %s" % (kind, path) for kind, path, paths, _ in named if not all(os.path.exists(p) for p in paths)]
    lost += ["%s %s (not an image that Blender reads)" % (kind, path) for kind, path, paths, owner in named
             if kind == "texture" and owner.source == "FILE" and os.path.exists(paths[0]) and not owner.size[0]]
    if lost:
        more = " and %d more" % (len(lost) - 8) if len(lost) > 8 else ""
        raise scene_failure("%s: %d of the %d files it names cannot be used: %s%s: put them there, or say what stands for one, "
                            "--substitute NAME=FILE" % (scene_name, len(lost), len(named), ", ".join(lost[:8]), more))
