// Whether a scene and a film can be meant.
#pragma once

#include "mesoshell/scene.h"

namespace mesoshell {

// Throw InvalidArgument, whose sentence names what is wrong.
void check_scene(const Scene& scene);
void check_film(const Film& film);

}  // namespace mesoshell
