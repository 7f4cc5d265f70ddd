#pragma once

#include "datasets/descriptions/scene.hpp"
#include "datasets/yaml/yaml_fields.hpp"

namespace clearway {

/// Reads what is wrong with a depth camera's images and poses: drawn from `seed` for a family of sensors
/// (`family`), given (`noise`, `errors`), or both, what is given winning.
void read_sensing(const YamlFields& fields, uint64_t seed, SceneDepth& depth);

/// The same of a camera's pictures: `family` and `errors`.
void read_picture_sensing(const YamlFields& fields, uint64_t seed, SceneCamera& camera);

/// {shift, turn, low_hz, high_hz} under `key`, what is left out being `usual`.
Shake read_shake(const YamlFields& fields, const std::string& key, const Shake& usual);

/// How the hand trembles: drawn from `seed` for a `person`, given (`tremor`, `wobble`, `wobble_hz`), or both.
void read_tremor(const YamlFields& fields, uint64_t seed, SceneStroke& stroke);

/// `hands` of a scene; capsules that are left out are the setup's.
SceneHands read_hands(const YamlFields& fields, const Setup& setup);

}  // namespace clearway
