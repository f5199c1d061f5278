"""Drawing: textures, programs, the draw code and its handler. Nothing here touches the GPU before something is drawn."""
