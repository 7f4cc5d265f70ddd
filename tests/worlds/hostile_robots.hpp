#pragma once

#include <stdexcept>
#include <string>

#include "mapping/files/map_file.hpp"
#include "planning/robot/robot.hpp"
#include "planning/robot_files/load_robot.hpp"
#include "tests/worlds/temporary_folder.hpp"

namespace clearway {

/// A folder of its own for a test's robot files.
class RobotFolder : public TemporaryFolder {
 public:
  /// The sentence with which loading r.urdf of this text ends, without the folder; "damaged: " before it
  /// where the program would end with 3, "accepted" when it loads.
  std::string refusal(const std::string& urdf) const { return refusal(RobotRequest{write("r.urdf", urdf)}); }
  std::string refusal(const RobotRequest& request) const {
    try {
      load_robot(request);
    } catch (const DamagedFile& error) {
      return "damaged: " + without_folder(error.what());
    } catch (const std::invalid_argument& error) {
      return without_folder(error.what());
    }
    return "accepted";
  }

 private:
  std::string without_folder(std::string text) const {
    const std::string prefix = path().string() + "/";
    for (std::size_t at; (at = text.find(prefix)) != std::string::npos;) text.erase(at, prefix.size());
    return text;
  }
};

/// A base and a link "arm" that carries `collision`, joined by a `type` joint "j" of this content.
inline std::string two_links(const std::string& collision, const std::string& type,
                             const std::string& joint) {
  return "<robot name='r'><link name='base'/><link name='arm'>" + collision +
         "</link><joint name='j' type='" + type + "'><parent link='base'/><child link='arm'/>" + joint +
         "</joint></robot>";
}

inline const std::string& sphere_collision() {
  static const std::string text = "<collision><geometry><sphere radius='0.1'/></geometry></collision>";
  return text;
}

inline const std::string& free_turn() {
  static const std::string text = "<axis xyz='0 0 1'/><limit lower='-1' upper='1' effort='1' velocity='1'/>";
  return text;
}

}  // namespace clearway
