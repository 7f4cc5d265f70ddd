#pragma once

#include <initializer_list>
#include <string_view>

#include "planning/robot_files/urdf_numbers.hpp"

namespace clearway {

// Each looks at one element of a URDF: its numbers, what it must hold, and what urdfdom would drop in
// silence. All throw std::invalid_argument in one sentence, and leave in the element only what is read from
// it.

/// A <collision>. Turns <capsule> into <cylinder>, which is all that urdfdom 3.0 knows, and says whether it
/// did.
bool check_urdf_collision(const UrdfPlace& place, tinyxml2::XMLElement& collision);

/// An <inertial>.
void check_urdf_inertial(const UrdfPlace& place, const tinyxml2::XMLElement& inertial);

/// Whether a <joint> lets a base float or drive over a plane.
bool is_base_joint(const tinyxml2::XMLElement& joint);

/// A <joint>, but for the links that it names. One of a base becomes fixed: the base stands where the map has
/// it.
/// @param is_of_base no joint above it moves
void check_urdf_joint(const UrdfPlace& place, tinyxml2::XMLElement& joint, bool is_of_base);

/// Leaves of an element's children only those of these names.
void keep_urdf_children(tinyxml2::XMLElement& element, std::initializer_list<std::string_view> names);

}  // namespace clearway
