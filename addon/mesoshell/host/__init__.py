"""bpy only: reading meshes and lights, properties, handlers, and what differs between Blender versions."""
