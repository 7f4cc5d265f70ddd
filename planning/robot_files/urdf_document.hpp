#pragma once

#include <filesystem>
#include <map>
#include <string>
#include <vector>

namespace clearway {

/// A URDF file after our own look at its XML, before urdfdom reads it. urdfdom 3.0 drops collision geometry
/// that it does not understand, accepts sizes below zero, zero axes, loops and two parents in silence, so
/// all of that is refused here, and so are misspelt names and numbers that no robot has. Limits keep the soft
/// ones of a <safety_controller>.
struct UrdfDocument {
  /// What a joint's <limit> says of its changes, rad or m by s^2 and s^3; 0: nothing.
  struct Changes {
    double acceleration = 0.0, jerk = 0.0;
  };

  /// Links and joints alone, with what is read of them; each <capsule> rewritten as a <cylinder> for urdfdom.
  std::string text;
  std::map<std::string, Changes> changes;               ///< of joints
  std::vector<std::string> joint_order;                 ///< names of all joints in the order of the file
  std::map<std::string, std::vector<bool>> is_capsule;  ///< per link, one flag for each <collision>
  std::vector<std::string> only_seen;                   ///< links with a <visual> and no <collision>
};

/// @param xacro arguments of a .xacro file
/// @throws std::invalid_argument in one sentence naming file, element and what was expected.
UrdfDocument read_urdf_document(const std::filesystem::path& file,
                                const std::map<std::string, std::string>& xacro = {});

/// The whole file as text; of a .xacro what the program `xacro` makes of it with these arguments.
/// @throws std::invalid_argument when it is missing, unreadable or above 16 MB.
std::string read_text(const std::filesystem::path& file,
                      const std::map<std::string, std::string>& xacro = {});

}  // namespace clearway
