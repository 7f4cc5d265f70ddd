#pragma once

#include "planning/robot_files/urdf_numbers.hpp"

namespace clearway {

/// Robot files carry elements and attributes of many programs, and readers skip what they do not know: a
/// misspelt <colision> or upper limit disappears in silence, and so does the second of two origins. Refuses
/// what looks like a slip of a name from which geometry, masses or kinematics are read, and such elements
/// given twice with different content; what resembles none of them belongs to somebody else and may stay.
/// `element` is a link or joint; looks at what is in it, too. @throws std::invalid_argument
void check_urdf_element(const UrdfPlace& place, const tinyxml2::XMLElement& element);

/// The same for <robot>, and nothing in it but the names of its elements.
void check_urdf_root(const UrdfPlace& place, const tinyxml2::XMLElement& robot);

}  // namespace clearway
