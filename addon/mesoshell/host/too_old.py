"""Registered instead of everything else where Blender's Python is older than the compiled module's."""

import sys

import bpy

SENTENCE = (f"Mesoshell needs Python 3.11 or later and this Blender has {sys.version_info[0]}.{sys.version_info[1]}: "
            "use Blender 4.1 or later (or your distribution's Blender, if it has Python 3.11)")


class MesoshellPreferences(bpy.types.AddonPreferences):
    bl_idname = __package__.rpartition(".")[0]

    def draw(self, context):
        self.layout.label(text=SENTENCE, icon='ERROR')


def register():
    # An exception here would be shown as a traceback; this is a line in the terminal and one in the preferences.
    print(SENTENCE)
    bpy.utils.register_class(MesoshellPreferences)


def unregister():
    bpy.utils.unregister_class(MesoshellPreferences)
