#pragma once

#include "datasets/descriptions/scene.hpp"

namespace clearway {

class YamlFields;

/// {name, box | cylinder | sphere, pose, grey} of a scene or suite; the map must hold nothing else.
/// @throws std::invalid_argument
SceneShape read_scene_shape(const YamlFields& fields);

}  // namespace clearway
