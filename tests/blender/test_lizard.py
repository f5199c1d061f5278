"""Laws of the committed scene blend_samples/lizard.blend: a closed cage, whole tiles around it, a motion that repeats."""

from pathlib import Path

import bpy
import numpy as np
import pytest

SAMPLES = Path(__file__).resolve().parents[2] / "blend_samples"


def append_lizard(path):
    with bpy.data.libraries.load(str(path)) as (_available, wanted):
        wanted.scenes = ["Lizard"]
    return wanted.scenes[0]


@pytest.fixture
def lizard(fresh):
    """The object, in a window scene of its own."""
    scene = append_lizard(SAMPLES / "lizard.blend")
    before = bpy.context.window.scene
    bpy.context.window.scene = scene
    try:
        yield next(obj for obj in scene.objects if obj.name.startswith("Lizard"))
    finally:
        bpy.context.window.scene = before
        for obj in list(scene.objects):
            bpy.data.objects.remove(obj)
        bpy.data.scenes.remove(scene)


def cage_arrays(mesh):
    """Positions [n, 3], quads [f, 4] and UVs [f, 4, 2]."""
    positions = np.array([vertex.co for vertex in mesh.vertices])
    quads = np.array([list(face.vertices) for face in mesh.polygons])
    uvs = np.empty(len(mesh.loops) * 2, np.float32)
    mesh.uv_layers[0].data.foreach_get("uv", uvs)
    return positions, quads, uvs.reshape(len(quads), 4, 2)


def shown(obj):
    evaluated = obj.evaluated_get(bpy.context.evaluated_depsgraph_get())
    mesh = evaluated.to_mesh()
    positions = np.array([vertex.co for vertex in mesh.vertices])
    evaluated.to_mesh_clear()
    return positions


def test_cage_is_closed_of_quads_and_faces_outward(lizard):
    positions, quads, _uvs = cage_arrays(lizard.data)
    edges = np.stack([quads, np.roll(quads, -1, axis=1)], axis=-1).reshape(-1, 2)
    assert len(np.unique(edges, axis=0)) == len(edges)
    assert set(map(tuple, edges)) == set(map(tuple, edges[:, ::-1]))
    assert len(positions) - len(edges) // 2 + len(quads) == 2, "a sphere with legs"
    middle = positions.mean(axis=0)
    triangles = positions[np.concatenate([quads[:, [0, 1, 2]], quads[:, [0, 2, 3]]])] - middle
    volume = np.einsum("ij,ij->", triangles[:, 0], np.cross(triangles[:, 1], triangles[:, 2])) / 6
    assert 0.2 < volume < 2.0


def test_left_and_right_are_mirror_images(lizard):
    positions, _quads, _uvs = cage_arrays(lizard.data)
    positions = np.round(positions.astype(np.float64), 4)
    assert {tuple(p + 0.0) for p in positions} == {tuple(p * (1, -1, 1) + 0.0) for p in positions}


def test_no_seam_around_the_body_cuts_the_pattern(lizard):
    """Across every edge between two faces of the tube, UVs differ by whole turns, which are whole tiles."""
    positions, quads, uvs = cage_arrays(lizard.data)
    assert lizard["mesoshell_tiles"][0] % 1 == 0
    rings, sides, legs = 15, 8, 4
    tube = (rings - 1) * sides - legs
    seen, turns = {}, 0
    for quad, uv in zip(quads[:tube], uvs[:tube]):
        for k in range(4):
            a, b = quad[k], quad[(k + 1) % 4]
            seen[a, b] = (uv[k], uv[(k + 1) % 4])
    for (a, b), (uv_a, uv_b) in seen.items():
        if (b, a) in seen:  # not an end, nor where a leg grows
            other_b, other_a = seen[b, a]
            differences = np.array([other_a - uv_a, other_b - uv_b])
            np.testing.assert_allclose(differences[:, 1], 0.0, atol=1e-5)
            np.testing.assert_allclose(differences[0], differences[1], atol=1e-5)
            assert np.isclose(differences[0, 0], np.round(differences[0, 0]), atol=1e-5)
            turns += round(abs(float(differences[0, 0])))
    beside_legs = 2
    assert turns == 2 * (rings - 1 - beside_legs), "one seam along the body, seen from both sides"


def test_motion_bends_the_tail_and_repeats(lizard):
    scene = bpy.context.scene
    scene.frame_set(1)
    first = shown(lizard)
    scene.frame_set(1 + scene.frame_end // 2)
    halfway = shown(lizard)
    scene.frame_set(scene.frame_end + 1)
    again = shown(lizard)
    np.testing.assert_allclose(again, first, atol=1e-5)
    moved = np.linalg.norm(halfway - first, axis=1)
    assert moved[np.argmin(first[:, 0])] > 0.2, "the tip of the tail"
    assert len(first) > 8 * len(lizard.data.vertices), "subdivided twice"


def test_committed_file_is_what_the_script_makes(lizard, made_samples):
    committed = cage_arrays(lizard.data)
    scene = append_lizard(made_samples / "lizard.blend")
    made = next(obj for obj in scene.objects if obj.data is not None and obj.data.name.startswith("Lizard"))
    for here, there in zip(committed, cage_arrays(made.data)):
        np.testing.assert_allclose(here, there, atol=1e-6)
    assert [m.type for m in made.modifiers] == [m.type for m in lizard.modifiers] == ['ARMATURE', 'SUBSURF']
    for obj in list(scene.objects):
        bpy.data.objects.remove(obj)
    bpy.data.scenes.remove(scene)
