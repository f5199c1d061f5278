"""The render engine: pictures by F12 and animations in the background, without a GPU."""
