"""The pictures of ./dev demo, inside Blender: reading the window, writing PNGs, and saying how far two pictures differ."""

from dataclasses import dataclass

import bpy
import gpu
import numpy as np
import x11_screen

BACKGROUND = np.array([0.045, 0.047, 0.052])  # linear


@dataclass
class Crop:
    """The middle of the 3D View's region, in pixels of the screen from its lower left corner."""

    x: int
    y: int
    size: int
    clip_from_world: np.ndarray  # of the crop alone, float64 [4, 4]


def set_view(camera, size):
    """Show what `camera` sees in the middle `size` by `size` pixels of the 3D View; redraws. Returns the Crop."""
    window = bpy.context.window_manager.windows[0]
    area = next(a for a in window.screen.areas if a.type == 'VIEW_3D')
    region = next(r for r in area.regions if r.type == 'WINDOW')
    space = area.spaces.active
    space.show_region_ui = space.show_region_toolbar = space.show_region_tool_header = False
    space.shading.type = 'SOLID'
    overlay = space.overlay  # overlays stay on: they bring the scene's depth
    for name in ("show_floor", "show_axis_x", "show_axis_y", "show_cursor", "show_text", "show_stats", "show_extras",
                 "show_relationship_lines", "show_outline_selected", "show_object_origins", "show_bones",
                 "show_motion_paths"):
        setattr(overlay, name, False)
    space.show_gizmo = False
    space.clip_start, space.clip_end = camera.data.clip_start, camera.data.clip_end
    for obj in bpy.context.view_layer.objects:
        obj.select_set(False)
    view = space.region_3d
    view.view_perspective = 'PERSP'
    view.view_matrix = camera.matrix_world.inverted()
    redraw()
    wanted = camera.calc_matrix_camera(bpy.context.evaluated_depsgraph_get(), x=size, y=size)[0][0]
    space.lens *= wanted / (view.window_matrix[0][0] * region.width / size)
    redraw()
    # Texel-exact middle: the crop's clip space is the region's, shifted by whole pixels and scaled.
    left, bottom = (region.width - size) // 2, (region.height - size) // 2
    if left < 0 or bottom < 0:
        raise RuntimeError(f"The 3D View is {region.width} by {region.height} pixels; the window must be larger")
    crop = np.eye(4)
    crop[0, 0], crop[1, 1] = region.width / size, region.height / size
    crop[0, 3] = (region.width - 2 * left - size) / size
    crop[1, 3] = (region.height - 2 * bottom - size) / size
    return Crop(window.x + region.x + left, window.y + region.y + bottom, size, crop @ np.array(view.perspective_matrix, np.float64))


def redraw():
    bpy.ops.wm.redraw_timer(type='DRAW_WIN_SWAP', iterations=1)


def read_window(crop):
    """What the screen shows of the crop: float32 [size, size, 3] as displayed (sRGB), row 0 at the bottom."""
    return x11_screen.read()[crop.y : crop.y + crop.size, crop.x : crop.x + crop.size]


def encode_srgb(linear):
    linear = np.clip(linear, 0.0, 1.0)
    return np.where(linear <= 0.0031308, 12.92 * linear, 1.055 * np.maximum(linear, 1e-9) ** (1 / 2.4) - 0.055)


def over_background(color):
    """Linear RGBA with coverage in alpha, over the pictures' background."""
    return color[..., :3] + (1.0 - color[..., 3:4]) * BACKGROUND


def save_png(path, rgb, *, encode):
    """Write [h, w, 3], row 0 at the bottom; linear color is encoded, what a screen showed is not."""
    height, width = rgb.shape[:2]
    pixels = np.ones((height, width, 4), np.float32)
    pixels[..., :3] = encode_srgb(rgb) if encode else rgb
    image = bpy.data.images.new(path.stem, width, height)
    image.colorspace_settings.name = "Non-Color"
    image.pixels.foreach_set(pixels.ravel())
    image.filepath_raw, image.file_format = str(path), 'PNG'
    image.save()
    bpy.data.images.remove(image)


def shade(normal_object, hit, eye, instance, lit):
    """Lambert of a traced mesh: linear RGBA [h, w, 4]. Written for itself, not from the shader."""
    normal = normal_object @ np.linalg.inv(instance.world_from_object[:3, :3])
    normal /= np.maximum(np.linalg.norm(normal, axis=-1, keepdims=True), 1e-12)
    cosine = np.maximum(normal @ lit.toward_sun, 0.0)[..., None]
    color = np.array(instance.settings.base_color[:3]) * (lit.ambient + lit.sun_color * cosine)
    covered = (hit == 1)[..., None]
    return np.concatenate([np.where(covered, color, 0.0), covered], axis=-1)


def solid_distance(native, objects, clip_from_world, size):
    """Distance from the eye to the nearest of ordinary mesh objects at every pixel, infinite beside them: [size, size]."""
    positions, triangles, count = [], [], 0
    for obj in objects:
        mesh = obj.data
        mesh.calc_loop_triangles()
        points = np.empty(len(mesh.vertices) * 3, np.float32)
        mesh.vertices.foreach_get("co", points)
        corners = np.empty(len(mesh.loop_triangles) * 3, np.int32)
        mesh.loop_triangles.foreach_get("vertices", corners)
        world = np.array(obj.matrix_world)
        positions.append(points.reshape(-1, 3) @ world[:3, :3].T + world[:3, 3])
        triangles.append(corners.reshape(-1, 3) + count)
        count += len(mesh.vertices)
    return native.trace(np.concatenate(positions), np.concatenate(triangles), clip_from_object=clip_from_world,
                        size=(size, size))["distance"]


def compare(name, picture, other_name, other, voxel):
    """Silhouettes and distances of two pictures; `voxel` in object units."""
    a, b = picture["hit"].astype(bool), other["hit"].astype(bool)
    both = a & b
    error = np.abs(picture["distance"][both] - other["distance"][both]) / voxel
    iou, same = both.sum() / (a | b).sum(), (a == b).mean()
    text = (f"hit mask equal on {same:.4%}, silhouette IoU {iou:.4f}, depth error in voxels: median {np.median(error):.3g}, "
            f"mean {error.mean():.3g}, 99th percentile {np.quantile(error, 0.99):.3g}")
    return {"picture": name, "against": other_name, "text": text, "mask_equal": float(same), "iou": float(iou),
            "median_voxels": float(np.median(error)), "mean_voxels": float(error.mean())}


def compare_window(name, displayed, other_name, drawn, solid):
    """The window against the offscreen draw: the shell where it is before the ordinary objects, they where they are.

    Pixels where the two are within a thousandth of each other are left out: Blender's depth buffer decides there.
    """
    alike = x11_screen.looks_like(displayed, drawn["color"][..., :3])
    before = drawn["hit"] & (drawn["distance"] < solid * 0.999)
    behind = drawn["hit"] & (drawn["distance"] > solid * 1.001)
    return {"picture": name, "against": other_name,
            "text": f"shell before cube and base: {alike[before].mean():.3%} of {before.sum()} pixels show its color; "
                    f"behind them: {alike[behind].mean():.3%} of {behind.sum()}",
            "shown": float(alike[before].mean()), "shown_behind": float(alike[behind].mean())}


def renderer():
    return f"{gpu.platform.renderer_get()}, {gpu.platform.backend_type_get()}"
