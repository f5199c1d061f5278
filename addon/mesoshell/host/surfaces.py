"""The objects that carry shells, as operators name them."""


def of_operator(context, name):
    """The mesh object of the scene that an operator means: of that name, or the active one; ValueError in a sentence."""
    if name:
        obj = context.scene.objects.get(name)
        if obj is None:
            raise ValueError(f'There is no object "{name}" in the scene "{context.scene.name}": '
                             "give the name of a mesh object")
    else:
        obj = context.view_layer.objects.active
        if obj is None:
            raise ValueError("There is no active object: select the surface first, or give its name")
    if obj.type != 'MESH':
        raise ValueError(f'"{obj.name}" is not a mesh: convert it (Object > Convert > Mesh), or pick another object')
    if obj.library is not None:
        raise ValueError(f'"{obj.name}" is linked from another file: make it local first')
    return obj


def with_shell(context, name):
    """The same, of objects that have a shell."""
    obj = of_operator(context, name)
    if not obj.mesoshell.enabled:
        raise ValueError(f'"{obj.name}" has no shell: pick an object that has one')
    return obj
