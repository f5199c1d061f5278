"""What the sidebar's panels share."""

import textwrap


class SidebarPanel:
    bl_space_type = 'VIEW_3D'
    bl_region_type = 'UI'
    bl_category = "Mesoshell"


def split_layout(panel):
    """A panel's layout with labels on the left and values on the right."""
    layout = panel.layout
    layout.use_property_split = True
    layout.use_property_decorate = False
    return layout


def draw_sentence(layout, context, sentence, icon):
    """A sentence in as many lines as the sidebar's width asks for."""
    if not sentence:
        return
    column = layout.column(align=True)
    width = context.region.width if context.region is not None else 240  # a panel in a popover has no region
    # Beside the text are the panel's borders, an icon and the sidebar's tabs.
    characters = max(16, int((width / context.preferences.system.ui_scale - 65) / 6.3))
    for index, line in enumerate(textwrap.wrap(sentence, characters)):
        column.label(text=line, icon=icon if index == 0 else 'BLANK1')
