#pragma once

#include <Eigen/Geometry>
#include <cstdint>
#include <filesystem>
#include <limits>
#include <memory>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include "datasets/yaml/yaml_gate.hpp"

namespace YAML {
class Node;
}

namespace clearway {

/// Bounds of a number, both included.
struct Bounds {
  double low = -std::numeric_limits<double>::infinity();
  double high = std::numeric_limits<double>::infinity();
};
constexpr double tiny = 1e-9;  ///< the smallest length that counts as positive
constexpr Bounds above_zero{tiny, 1e6};
constexpr Bounds not_negative{0, 1e6};
constexpr Bounds within_reach{-1e6, 1e6};
constexpr Bounds paddings{0, 100};         ///< metres
constexpr Bounds robot_scales{1e-6, 1e3};  ///< least_scale and most_scale of planning/robot/robot.hpp

/// A YAML map that is being read. Each function asks for one key; whatever is wrong with its value becomes a
/// std::invalid_argument in one sentence naming file, line and key. `finish` then refuses the keys that
/// nobody asked for. Numbers are read the same way in every locale.
class YamlFields {
 public:
  /// @throws std::invalid_argument when `text` is not a YAML map. `name` is what errors call it, for example
  /// "setup 'kitchen.yaml'". @param bounds see require_yaml
  YamlFields(const std::string& text, const std::string& name, const YamlBounds& bounds = {});

  bool has(const std::string& key) const;
  bool names(const std::string& key) const;     ///< has it, if with nothing after it
  bool is_list(const std::string& key) const;   ///< false for what is absent, too
  bool is_map(const std::string& key) const;    ///< the same
  bool is_empty(const std::string& key) const;  ///< a list or map without entries, or absent
  bool is_word(const std::string& key) const;   ///< a scalar that is no number
  double number(const std::string& key, Bounds bounds) const;
  double number(const std::string& key, Bounds bounds, double otherwise) const;
  std::optional<double> optional_number(const std::string& key, Bounds bounds) const;
  int integer(const std::string& key, Bounds bounds) const;
  int integer(const std::string& key, Bounds bounds, int otherwise) const;
  std::uint64_t seed(const std::string& key, std::uint64_t otherwise) const;  ///< any of 64 bits
  bool boolean(const std::string& key) const;
  /// The number of a single control character, as ROS 2 writes a byte: 0 for "\0", or of one byte as
  /// `!!binary`, as Python does. None: it is something else.
  std::optional<int> control_character(const std::string& key) const;
  /// A name or another word: at most 80 characters and no control characters, so that any sentence may repeat
  /// it.
  std::string text(const std::string& key) const;
  std::string text(const std::string& key, const std::string& otherwise) const;
  std::string file(const std::string& key) const;  ///< a path, at most 255 characters of the same kind
  /// The name of a shipped robot as it is; a robot's file from `folder`.
  std::string robot(const std::string& key, const std::filesystem::path& folder) const;
  std::string prose(const std::string& key, const std::string& otherwise) const;  ///< lines; up to 10,000
  std::string text_or_numbers(const std::string& key) const;  ///< of a list of numbers: "0.1, 0.2"
  std::vector<std::string> texts(const std::string& key) const;
  /// The same, of which none may be empty.
  std::vector<std::string> full_texts(const std::string& key) const;  ///< a list, empty when absent
  /// Lists of words, each as it is or under `name` in a map of its own; empty when absent.
  std::vector<std::vector<std::string>> lists_of_texts(const std::string& key, const std::string& name) const;
  std::vector<double> numbers(const std::string& key, Bounds) const;  ///< a list of any length
  std::vector<double> numbers(const std::string& key, Bounds, size_t size) const;
  /// A list, or lists of one row or of one column, as a matrix of numbers is written.
  std::vector<double> flat_numbers(const std::string& key, Bounds) const;
  std::vector<std::vector<double>> lists_of_numbers(const std::string& key, Bounds, size_t size) const;
  std::vector<std::vector<double>> lists_of_numbers(const std::string& key,
                                                    Bounds) const;  ///< of any lengths
  /// Rows of `size` numbers, each a list or a map with `names`, which hold a number or a list of them; or one
  /// list with the numbers of all rows.
  std::vector<std::vector<double>> rows(const std::string& key, Bounds, size_t size,
                                        const std::vector<std::string>& names) const;
  Eigen::Vector3d vector(const std::string& key) const;
  /// Angles in radians under `key`, or in degrees under `key`_deg.
  std::vector<double> angles(const std::string& key) const;
  std::vector<std::vector<double>> lists_of_angles(const std::string& key) const;
  /// Of a list whose items may be words in place of lists: the word of each item, else "", and the list of
  /// each, else an empty one.
  std::vector<std::string> words_among(const std::string& key) const;
  std::vector<std::vector<double>> lists_among(const std::string& key) const;
  double angle(const std::string& key, double otherwise) const;  ///< how far something turns: 0 or more
  bool has_angles(const std::string& key) const;
  /// [x, y, z, roll, pitch, yaw]: metres and Rz(yaw) Ry(pitch) Rx(roll); angles as in `angles`.
  Eigen::Isometry3d pose(const std::string& key) const;
  Eigen::Isometry3d pose(const std::string& key, const Eigen::Isometry3d& otherwise) const;
  /// Same for the turn alone: [roll, pitch, yaw].
  Eigen::Matrix3d rotation(const std::string& key) const;

  YamlFields map(const std::string& key) const;
  std::vector<YamlFields> list_of_maps(const std::string& key) const;  ///< empty when absent
  std::vector<std::string> keys() const;  ///< all of them, in the file's order; counts as asking for each

  /// @throws std::invalid_argument when a key is left that was never asked for.
  void finish() const;
  /// Throws the sentence "<file>, line <n>, <key>: <what>."
  [[noreturn]] void fail(const std::string& key, const std::string& what) const;

 private:
  YamlFields(const YAML::Node& node, const std::string& name, const std::string& path);
  YAML::Node find(const std::string& key) const;
  YAML::Node required(const std::string& key) const;
  std::string meant_by(const std::string& key) const;
  double number_of(const YAML::Node& node, const std::string& key, Bounds bounds) const;
  std::vector<std::string> texts_of(const YAML::Node& node, const std::string& key) const;
  std::vector<double> numbers_of(const YAML::Node& node, const std::string& key, Bounds bounds) const;
  std::vector<double> angles_of(const YAML::Node& node, const std::string& key,
                                const std::string& given) const;
  std::vector<double> row_of(const YAML::Node& node, const std::string& key, Bounds bounds,
                             const std::vector<std::string>& names) const;
  std::string checked_text(const std::string& text, const std::string& key, size_t longest) const;
  std::string degrees_key(const std::string& key) const;
  void require_within_turn(const std::string& key, double given) const;
  void check_map() const;

  std::shared_ptr<const YAML::Node> node_;
  std::string name_, path_;
  mutable std::set<std::string> asked_;
};

/// Rz(yaw) Ry(pitch) Rx(roll).
Eigen::Matrix3d rotation_from_rpy(double roll, double pitch, double yaw);

/// What a message calls a node: a scalar by its quoted text, else "a list", "a map" or "nothing".
std::string shown_node(const YAML::Node& node);

}  // namespace clearway
