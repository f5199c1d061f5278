"""What is drawn over shells to judge them: properties of the scene."""

import bpy
from bpy.props import BoolProperty, EnumProperty, FloatProperty, FloatVectorProperty, PointerProperty

from .shell_options import tag_redraw

MEASURES = (
    ("rms", "Length", "RMS stretch: by how much the tile is longer on the surface than it should be, or shorter"),
    ("angle", "Angle", "How far the texture's axes are from a right angle"),
)


def _color(name, description, default):
    return FloatVectorProperty(name=name, description=description, subtype='COLOR', size=4, min=0.0, max=1.0,
                               default=default, update=tag_redraw)


class MesoshellOverlays(bpy.types.PropertyGroup):
    """Overlays of all shells of a scene; colors are linear, with their opacity."""

    show_prisms: BoolProperty(name="Prisms", description="Edges of all prisms", update=tag_redraw)
    show_folds: BoolProperty(name="Folds", description="Prisms that are inverted or cross another one", update=tag_redraw)
    show_stretch: BoolProperty(name="Stretch", description="How far the texture is stretched, on the top of the shell",
                               update=tag_redraw)
    show_seams: BoolProperty(name="Cut Seams", description="Seams of the UVs where the pattern does not go on",
                             update=tag_redraw)
    measure: EnumProperty(name="Measure", description="What stretch is", items=MEASURES, default="rms", update=tag_redraw)
    most_stretch: FloatProperty(name="Range", description="The stretch that has the strongest color; its reciprocal has the "
                                "other one", default=2.0, min=1.01, max=100.0, update=tag_redraw)
    most_angle: FloatProperty(name="Range", description="The deviation from a right angle that has the strongest color",
                              subtype='ANGLE', default=1.0471976, min=0.01, max=1.5707963, update=tag_redraw)

    prism_color: _color("Prisms", "Edges of prisms", (0.0, 0.0, 0.0, 0.4))
    fold_color: _color("Folds", "Prisms that fold: less thickness, smoother directors or a repair mend them",
                       (0.9, 0.01, 0.02, 0.75))
    base_fold_color: _color("Base Folds", "Where the surface itself folds or crosses itself: no thickness mends that",
                            (1.0, 0.25, 0.0, 0.75))
    seam_color: _color("Cut Seams", "Seams that cut the pattern", (0.75, 0.0, 0.9, 1.0))
    low_color: _color("Compressed", "The tile is shorter on the surface than it should be", (0.02, 0.12, 0.85, 0.85))
    even_color: _color("Even", "The tile is as it should be", (0.75, 0.75, 0.72, 0.85))
    high_color: _color("Stretched", "The tile is longer on the surface than it should be", (0.85, 0.08, 0.0, 0.85))

    def any_shown(self):
        """Whether there is anything to draw."""
        return self.show_prisms or self.show_folds or self.show_stretch or self.show_seams


def register():
    bpy.utils.register_class(MesoshellOverlays)
    bpy.types.Scene.mesoshell_overlays = PointerProperty(type=MesoshellOverlays)


def unregister():
    del bpy.types.Scene.mesoshell_overlays
    bpy.utils.unregister_class(MesoshellOverlays)
