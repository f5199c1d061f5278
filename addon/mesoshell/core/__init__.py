"""No bpy, no gpu: finding the compiled module, background jobs, the order of the stages, shader text."""
