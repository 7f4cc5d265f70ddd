#pragma once

#include <filesystem>
#include <limits>
#include <string>
#include <string_view>
#include <vector>

namespace tinyxml2 {
class XMLElement;
}

namespace clearway {

/// Where in a robot file something is: what every refusal begins with.
struct UrdfPlace {
  const std::filesystem::path& file;
  std::string where;  ///< "joint 'j'"

  /// @throws std::invalid_argument "FILE: WHERE: WHAT".
  [[noreturn]] void refuse(const std::string& what) const;
};

/// What a number of a robot file may be. Wide enough for any robot, and narrow enough that no sum, product or
/// square of such numbers loses what the next one says.
struct UrdfRange {
  double least = 0.0, most = 0.0;
  const char* unit = "";
};

constexpr UrdfRange urdf_metres{-1e3, 1e3, "metres"};
constexpr UrdfRange urdf_radians{-12.6, 12.6, "radians"};  ///< roll, pitch, yaw: two turns
constexpr UrdfRange urdf_size{1e-6, 1e3, "metres"};
constexpr UrdfRange urdf_turns{-1e3, 1e3, "radians"};  ///< limits of a revolute joint
constexpr UrdfRange urdf_speed{0.0, 1e6, "rad/s or m/s"};
constexpr UrdfRange urdf_any{-std::numeric_limits<double>::max(), std::numeric_limits<double>::max(),
                             "finite numbers"};  ///< gated elsewhere, or used by nobody

/// The finite number that a word is from its first character to its last: decimal, with a point, whatever the
/// locale; else NaN.
double decimal_number(std::string_view word);

/// "metres in [-1000, 1000]"
std::string text_of(const UrdfRange& range);

/// The `count` numbers of an attribute, separated by blanks: decimal, with a point, whatever the locale.
/// @throws std::invalid_argument when it is missing, holds another count, anything but finite numbers, or one
///         out of `range`.
std::vector<double> urdf_numbers(const UrdfPlace& place, const tinyxml2::XMLElement& element,
                                 const char* attribute, std::size_t count, const UrdfRange& range);

/// Checks xyz and rpy of the <origin> in `parent`, where it has one.
void check_urdf_origin(const UrdfPlace& place, const tinyxml2::XMLElement& parent);

}  // namespace clearway
