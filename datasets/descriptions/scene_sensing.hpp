#pragma once

#include "datasets/descriptions/scene.hpp"
#include "datasets/descriptions/yaml_fields.hpp"

namespace clearway {

/// Reads what is wrong with a depth camera's images and poses: drawn from `seed` for a family of sensors
/// (`family`), given (`noise`, `errors`), or both, what is given winning.
void read_sensing(const YamlFields& fields, uint64_t seed, SceneDepth& depth);

}  // namespace clearway
