"""lizard.blend: a coarse cage that a Subdivision Surface modifier rounds and an armature bends, with scales on a part of it.

Head and feet stay plain, as the dinosaur's of the GDM paper (Wang et al. 2004, figure 9). The UVs of body and tail go once
around in u and keep angles along v, so that with whole numbers of tiles along u no seam cuts the pattern.
"""

import bpy
import numpy as np
from mathutils import Vector

from scene_parts import add_object, look_through_camera, make_material, mesh_from_arrays, set_tile_settings, use_nodes
from tiles import squama

SIDES = 8
# From the tip of the tail to the nose: x, z of the middle, half width, half height; scene units (meters).
RINGS = np.array([
    (-2.30, 0.10, 0.020, 0.020), (-2.00, 0.08, 0.045, 0.040), (-1.65, 0.07, 0.080, 0.070), (-1.30, 0.08, 0.115, 0.100),
    (-0.95, 0.10, 0.155, 0.135), (-0.62, 0.12, 0.220, 0.180), (-0.34, 0.13, 0.270, 0.215), (-0.02, 0.13, 0.300, 0.230),
    (0.30, 0.13, 0.290, 0.220), (0.56, 0.14, 0.240, 0.190), (0.82, 0.17, 0.170, 0.150), (1.04, 0.20, 0.165, 0.135),
    (1.28, 0.21, 0.190, 0.120), (1.50, 0.19, 0.120, 0.080), (1.62, 0.18, 0.060, 0.045)])
HEAD_X = 0.95  # in front of it, the head is plain
# The rings between which a leg grows, and its stations: offset from the face (x, outward, z) and size over the face's.
LEGS = {5: ((-0.06, 0.16, -0.05, 0.8), (0.02, 0.27, -0.15, 0.6), (0.0, 0.30, -0.27, 0.45), (0.06, 0.31, -0.36, 0.8)),
        8: ((-0.02, 0.16, -0.05, 0.8), (-0.10, 0.27, -0.15, 0.6), (-0.02, 0.30, -0.27, 0.45), (0.04, 0.31, -0.36, 0.8))}
LEG_FACES = (0, 6)  # low on the left and on the right
TAIL_BONES, FRAMES = 5, 48
TILES = (6, 8)  # whole around the body; along it, what squama's aspect of 0.75 asks for
THICKNESS = 0.05


class Cage:
    """Vertices, quads, UVs by corner and, a vertex each, the share of the thickness and whether it is scaly."""

    def __init__(self):
        self.positions, self.quads, self.uvs, self.share, self.scaly = [], [], [], [], []

    def vertex(self, position, share, scaly):
        self.positions.append(position)
        self.share.append(share)
        self.scaly.append(scaly)
        return len(self.positions) - 1

    def quad(self, corners, uvs):
        self.quads.append(corners)
        self.uvs.extend(uvs)


def ring_lengths():
    """v of each ring: the way along the body over the circumference there, integrated, so that tiles keep their angles."""
    radius = (RINGS[:, 2] + RINGS[:, 3]) / 2
    middle = (radius[1:] + radius[:-1]) / 2
    step = np.linalg.norm(np.diff(RINGS[:, :2], axis=0), axis=1)
    return np.concatenate([[0.0], np.cumsum(step / (2 * np.pi * middle))])


def body_share(x):
    """Scales thin out toward the neck and the tip of the tail."""
    return float(np.clip(min((x + 2.5) / 0.9, (HEAD_X + 0.25 - x) / 0.5), 0.15, 1.0))


def add_body(cage):
    """The tube from tail to nose without the faces that legs grow from; returns those by (ring, side)."""
    angles = (np.arange(SIDES) + 0.5) * 2 * np.pi / SIDES - np.pi / 2
    rings = [[cage.vertex((x, width * np.cos(a), z + height * np.sin(a)), body_share(x), x < HEAD_X) for a in angles]
             for x, z, width, height in RINGS]
    along = ring_lengths()
    roots = {}
    for i in range(len(rings) - 1):
        for k in range(SIDES):
            after = (k + 1) % SIDES
            corners = (rings[i][k], rings[i][after], rings[i + 1][after], rings[i + 1][k])
            if i in LEGS and k in LEG_FACES:
                roots[i, k] = corners
                continue
            u, v = np.array([k, k + 1]) / SIDES, along[i:i + 2]
            cage.quad(corners, [(u[0], v[0]), (u[1], v[0]), (u[1], v[1]), (u[0], v[1])])
    for ring, end in ((rings[0][::-1], along[0]), (rings[-1], along[-1])):
        for corners in ((0, 1, 2, 3), (0, 3, 4, 7), (4, 5, 6, 7)):
            positions = np.array([cage.positions[ring[c]] for c in corners])
            cage.quad([ring[c] for c in corners], (positions[:, 1:] + (0.0, end)).tolist())
    return roots


def turned_about_x(angle):
    cosine, sine = np.cos(angle), np.sin(angle)
    return np.array([[1.0, 0.0, 0.0], [0.0, cosine, -sine], [0.0, sine, cosine]])


def add_leg(cage, root, stations):
    """A tube of four sides from a face of the body, ending in a foot; v falls toward it, where scales point."""
    start = np.array([cage.positions[corner] for corner in root])
    middle = start.mean(axis=0)
    side = np.sign(middle[1])
    around = np.linalg.norm(np.diff(start, axis=0, append=start[:1]), axis=1).sum()
    normal = np.cross(start[2] - start[0], start[3] - start[1])
    turn = np.arctan2(-normal[1], -normal[2])  # takes the face's normal to -z
    before, v = list(root), 0.0
    for index, (forward, outward, rise, size) in enumerate(stations):
        # From lying in the body's side, the section turns about x until it lies flat above the ground.
        offsets = (start - middle) * size @ turned_about_x(turn * (index + 1) / len(stations)).T
        center = middle + (forward, side * outward, rise)
        last = index == len(stations) - 1
        ring = [cage.vertex(tuple(center + offset), 0.5 if index < 2 else 0.15, index < 2) for offset in offsets]
        length = np.linalg.norm(center - np.mean([cage.positions[c] for c in before], axis=0)) / around
        for k in range(4):
            after = (k + 1) % 4
            cage.quad((before[k], before[after], ring[after], ring[k]),
                      [(-k / 4, -v), (-(k + 1) / 4, -v), (-(k + 1) / 4, -v - length), (-k / 4, -v - length)])
        before, v = ring, v + length
        if last:
            cage.quad(ring, [(0.0, 0.0), (0.25, 0.0), (0.25, 0.25), (0.0, 0.25)])


def make_cage():
    cage = Cage()
    for (ring, _side), root in add_body(cage).items():
        add_leg(cage, root, LEGS[ring])
    return cage


def bone_joints():
    """x, z of the joints from the neck to the tip of the tail: one bone between each two."""
    x = np.array([1.62, 0.82, 0.30, -0.34, *np.linspace(-0.62, -2.30, TAIL_BONES + 1)])
    return np.stack([x, np.interp(x, RINGS[:, 0], RINGS[:, 1])], axis=1)


def add_armature(cage_object):
    """A chain of bones along the spine; weights fall off linearly between the middles of neighboring bones."""
    joints = bone_joints()
    armature = bpy.data.armatures.new("Spine")
    obj = add_object("Spine", armature)
    bpy.context.view_layer.objects.active = obj
    bpy.ops.object.mode_set(mode='EDIT')
    names, parent = [], None
    for index, (head, tail) in enumerate(zip(joints[:-1], joints[1:])):
        bone = armature.edit_bones.new(f"Spine.{index:03d}")
        bone.head, bone.tail = (head[0], 0.0, head[1]), (tail[0], 0.0, tail[1])
        bone.align_roll((0.0, 0.0, 1.0))
        bone.parent, bone.use_connect = parent, parent is not None
        parent = bone
        names.append(bone.name)
    bpy.ops.object.mode_set(mode='OBJECT')

    middles = (joints[:-1, 0] + joints[1:, 0]) / 2
    x = np.array([vertex.co.x for vertex in cage_object.data.vertices])
    for index, name in enumerate(names):
        hat = np.zeros(len(middles))
        hat[index] = 1.0
        weights = np.interp(x, middles[::-1], hat[::-1])
        group = cage_object.vertex_groups.new(name=name)
        for vertex in np.flatnonzero(weights > 0.0):
            group.add([int(vertex)], float(weights[vertex]), 'REPLACE')
    modifier = cage_object.modifiers.new("Armature", 'ARMATURE')
    modifier.object = obj
    return obj, names


def animate(armature, names):
    """A wave that runs down the tail, and a nod against it; frame FRAMES + 1 is frame 1 again."""
    for index, name in enumerate(names):
        bone = armature.pose.bones[name]
        bone.rotation_mode = 'XYZ'
        size = np.radians(4.0 + 3.0 * max(0, index - 2))
        for frame in range(1, FRAMES + 2, 6):
            bone.rotation_euler = (0.0, 0.0, size * np.sin(2 * np.pi * (frame - 1) / FRAMES - 0.8 * index))
            bone.keyframe_insert("rotation_euler", index=2, frame=frame)


def add_lizard():
    """The cage with its vertex groups, Armature and Subdivision Surface; what shell suits it is stored as a suggestion."""
    cage = make_cage()
    skin = make_material("Skin", (0.20, 0.24, 0.12), 0.0, 0.5)
    mesh = mesh_from_arrays("Lizard", np.array(cage.positions), np.array(cage.quads), skin)
    mesh.uv_layers.new(name="UVMap").data.foreach_set("uv", np.array(cage.uvs, np.float32).ravel())
    obj = add_object("Lizard", mesh)
    for name, values in (("Scales", np.array(cage.scaly, float)), ("Thickness", np.array(cage.share))):
        group = obj.vertex_groups.new(name=name)
        for vertex, value in enumerate(values):
            group.add([vertex], float(value), 'REPLACE')
    armature, names = add_armature(obj)
    subdivision = obj.modifiers.new("Subdivision", 'SUBSURF')
    subdivision.levels = subdivision.render_levels = 2
    animate(armature, names)
    armature.hide_render = True
    obj["mesoshell_tiles"], obj["mesoshell_thickness"] = TILES, THICKNESS
    bpy.context.view_layer.objects.active = obj
    obj.select_set(True)


def add_tile(detail):
    """The scales, aside and out of the picture."""
    tile = squama.make(0.6 * detail)
    material = make_material("Scales", None, 0.0, 0.45)
    obj = add_object("SquamaTile", mesh_from_arrays("SquamaTile", tile.positions, tile.triangles, material, tile.colors),
                     (0.0, 1.5, 0.0))
    obj.hide_render = True
    set_tile_settings(obj, (1.0, tile.aspect), tile.height)


def add_light_and_camera():
    sun = bpy.data.lights.new("Sun", "SUN")
    sun.energy, sun.angle = 3.5, np.radians(1.0)
    add_object("Sun", sun, (-3.0, -2.0, 4.0), np.radians((40.0, -18.0, 0.0)))
    camera = bpy.data.cameras.new("Camera")
    camera.lens = 50.0
    toward = Vector((0.42, -0.68, 0.60)).normalized()
    obj = add_object("Camera", camera, toward * 5.9 + Vector((-0.36, 0.0, -0.05)), toward.to_track_quat("Z", "Y").to_euler())
    bpy.context.scene.camera = obj


def build(detail):
    """Fills the empty scene; the tile has about 3 600 detail^2 triangles."""
    scene = bpy.context.scene
    scene.name = "Lizard"
    scene.render.resolution_x, scene.render.resolution_y = 768, 512
    scene.render.filepath = "//"
    scene.view_settings.view_transform = "Standard"
    scene.frame_start, scene.frame_end = 1, FRAMES
    scene.world = bpy.data.worlds.new("World")
    scene.world.color = (0.05, 0.05, 0.05)
    background = next(node for node in use_nodes(scene.world) if node.type == "BACKGROUND")
    background.inputs["Color"].default_value = (0.05, 0.05, 0.05, 1.0)
    add_tile(detail)
    add_lizard()
    add_light_and_camera()
    look_through_camera()
