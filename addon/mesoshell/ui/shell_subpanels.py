"""Below the panel of a shell: its surface, extrusion, placement, what is wrong with it, and overlays."""

import math

import bpy

from ..host import shell_checks, shells
from .parts import SidebarPanel, draw_sentence, split_layout


class ShellPanel(SidebarPanel):
    """Of the active object, if it has a shell."""

    bl_parent_id = "MESOSHELL_PT_shell"
    bl_options = {'DEFAULT_CLOSED'}

    @classmethod
    def poll(cls, context):
        obj = context.view_layer.objects.active
        return obj is not None and obj.type == 'MESH' and obj.mesoshell.enabled

    def start(self, context):
        """The layout, the object and its settings."""
        obj = context.view_layer.objects.active
        return split_layout(self), obj, obj.mesoshell


class MESOSHELL_PT_shell_surface(ShellPanel, bpy.types.Panel):
    bl_label = "Surface"

    def draw(self, context):
        layout, obj, settings = self.start(context)
        layout.prop(settings, "surface")
        column = layout.column(align=True)
        column.prop(settings, "part")
        if settings.part == 'MATERIAL':
            column.prop_search(settings, "part_name", obj, "material_slots", text=" ")
        elif settings.part == 'VERTEX_GROUP':
            column.prop_search(settings, "part_name", obj, "vertex_groups", text=" ")
        elif settings.part == 'ATTRIBUTE':
            column.prop_search(settings, "part_name", obj.data, "attributes", text=" ")
        column = layout.column(align=True)
        column.prop(settings, "refine")
        if settings.refine == 'LENGTH':
            column.prop(settings, "edge_length", text=" ")
        elif settings.refine == 'SCREEN':
            column.prop(settings, "edge_pixels", text=" ")
        if settings.refine != 'LEVELS':
            column.prop(settings, "most_levels")
        layout.prop(settings, "subdivision")
        if settings.subdivision == 'OWN':
            column = layout.column(align=True)
            if settings.refine == 'LEVELS':
                column.prop(settings, "levels")
            smooth = column.column(align=True)
            smooth.active = settings.refine != 'LEVELS' or settings.levels > 0
            for name in ("scheme", "boundary", "uv_rule", "use_creases"):
                smooth.prop(settings, name)


class MESOSHELL_PT_shell_extrusion(ShellPanel, bpy.types.Panel):
    bl_label = "Extrusion"

    def draw(self, context):
        layout, obj, settings = self.start(context)
        layout.prop(settings, "offset")
        layout.prop_search(settings, "thickness_group", obj, "vertex_groups", text="Thickness Group")
        layout.prop(settings, "thickness_image", text="Thickness Image")
        layout.prop(settings, "smooth_directors")
        layout.prop(settings, "fins")


class MESOSHELL_PT_shell_placement(ShellPanel, bpy.types.Panel):
    bl_label = "Placement"

    def draw(self, context):
        layout, _obj, settings = self.start(context)
        layout.prop(settings, "placement", text="Count")
        column = layout.column(align=True)
        column.prop(settings, "tiles_u")
        column.prop(settings, "tiles_v", text="V")
        layout.prop(settings, "uv_rotation")
        layout.prop(settings, "uv_offset")


class MESOSHELL_PT_shell_folds(ShellPanel, bpy.types.Panel):
    bl_label = "Folds & Distortion"

    def draw(self, context):
        layout, obj, settings = self.start(context)
        layout.prop(settings, "repair")
        layout.prop(settings, "relax")
        layout.operator("mesoshell.check_shell", icon='VIEWZOOM')
        report, drawn = shell_checks.last_report(obj), shells.drawn(obj)
        if report is None:
            return
        column = layout.column(align=True)
        column.active = drawn is not None and drawn[1] == report.shell_version
        if not column.active:
            column.label(text="Of an earlier shell:")
        for name, value, bad in _figures(report):
            split = column.split(factor=0.6)
            split.label(text=name, icon='ERROR' if bad else 'CHECKMARK')
            split.label(text=value)
        if report.base_folds:
            draw_sentence(layout, context, "The surface itself folds: no thickness mends that", 'INFO')


class MESOSHELL_PT_shell_overlays(ShellPanel, bpy.types.Panel):
    bl_label = "Overlays"

    def draw(self, context):
        layout = split_layout(self)
        settings = context.scene.mesoshell_overlays
        for shown, colors in (("show_prisms", ("prism_color",)), ("show_folds", ("fold_color", "base_fold_color")),
                              ("show_seams", ("seam_color",)),
                              ("show_stretch", ("low_color", "even_color", "high_color"))):
            row = layout.split(factor=0.5)
            row.use_property_split = False
            row.prop(settings, shown)
            swatches = row.row(align=True)
            swatches.active = getattr(settings, shown)
            if shown == "show_stretch" and settings.measure == "angle":
                colors = colors[1:]
            for name in colors:
                swatches.prop(settings, name, text="")
        if settings.show_stretch:
            column = layout.column(align=True)
            column.prop(settings, "measure")
            column.prop(settings, "most_stretch" if settings.measure == "rms" else "most_angle")
            low, even, high = _legend(settings)
            row = column.row()
            row.alignment = 'RIGHT'
            row.label(text=f"{low}    {even}    {high}".strip())
        if settings.any_shown() and context.space_data is not None and not context.space_data.overlay.show_overlays:
            draw_sentence(layout, context, "Overlays of this view are off", 'INFO')


def _figures(report):
    """Rows of (name, value, whether it should not be)."""
    yield "Prisms", f"{report.prisms:,}", False
    yield "Folds", f"{report.folds:,}" + (f" ({report.base_folds:,} base)" if report.base_folds else ""), report.folds > 0
    yield "Cut seams", f"{report.cut_seams:,}", report.cut_seams > 0
    if report.without_area:
        yield "No UV area", f"{report.without_area:,}", True
    yield "Worst stretch", f"{report.worst_stretch:.3g} ×", report.worst_stretch > 2.0
    yield "Worst skew", f"{math.degrees(report.worst_angle):.0f}°", report.worst_angle > math.radians(45.0)


def _legend(settings):
    if settings.measure == "rms":
        return f"1/{settings.most_stretch:.2g}", "1", f"{settings.most_stretch:.2g} ×"
    return "", "90°", f"90 ± {math.degrees(settings.most_angle):.0f}°"


CLASSES = (MESOSHELL_PT_shell_surface, MESOSHELL_PT_shell_extrusion, MESOSHELL_PT_shell_placement, MESOSHELL_PT_shell_folds,
           MESOSHELL_PT_shell_overlays)


def register():
    for cls in CLASSES:
        bpy.utils.register_class(cls)


def unregister():
    for cls in reversed(CLASSES):
        bpy.utils.unregister_class(cls)
