#pragma once

#include <Eigen/Geometry>
#include <map>
#include <memory>
#include <nlohmann/json_fwd.hpp>
#include <string>
#include <utility>
#include <vector>

#include "mapping/voxels/voxel_state.hpp"

namespace clearway {

/// One value of a JSON file with its name, so that every complaint can say where it is: "plan file p.json:
/// field 'legs[2].status': expected …". The JSON must outlive it.
/// @throws std::invalid_argument from every member that finds something else than it is asked for.
class JsonField {
 public:
  /// @param file what the file is called in a complaint: "plan file p.json"
  JsonField(const nlohmann::ordered_json& root, std::string file);

  [[noreturn]] void refuse(const std::string& expected) const;
  [[noreturn]] void fail(const std::string& what) const;  ///< the same, where "expected …" says it badly

  bool has(const char* key) const;
  JsonField at(const char* key) const;
  std::vector<JsonField> items() const;
  std::vector<std::pair<std::string, JsonField>> members() const;

  bool is_null() const;
  bool is_text() const;
  bool is_composed() const;  ///< a list or an object with something in it
  std::string text() const;
  double number() const;  ///< finite
  std::size_t count() const;
  int whole_number() const;  ///< within 2,000,000,000
  bool flag() const;
  Eigen::VectorXd numbers(std::size_t size) const;
  std::vector<Eigen::VectorXd> vectors(std::size_t size) const;  ///< a list of `numbers`

 private:
  JsonField(const nlohmann::ordered_json& value, std::shared_ptr<const std::string> file, std::string name);
  JsonField item(std::size_t index) const;
  std::string inner(const std::string& key) const;  ///< how a field of this one is called

  const nlohmann::ordered_json* value_;
  std::shared_ptr<const std::string> file_;  ///< one for all: a plan has a million values
  std::string name_;
};

// What plan.json and queries.json both hold, in one way.

nlohmann::ordered_json json_of(const Eigen::VectorXd& values);
nlohmann::ordered_json json_of(const std::vector<Eigen::VectorXd>& list);

/// A homogeneous 4x4 matrix, row by row: reads back bit for bit, as a quaternion would not.
nlohmann::ordered_json json_of(const Eigen::Isometry3d& pose);
Eigen::Isometry3d pose_of(const JsonField& field);

/// Part to policy.
nlohmann::ordered_json json_of(const std::map<std::string, Policy>& policies);
std::map<std::string, Policy> policies_of(const JsonField& field);

/// A length that a body keeps, metres: finite and not below 0.
double padding_of(const JsonField& field);

/// A mass at the tip, kg at full size: 0 to 1,000,000.
double payload_of(const JsonField& field);

/// m/s^2, at most 1,000.
Eigen::Vector3d gravity_of(const JsonField& field);

/// How long a look counts, seconds: finite and not below 0; 0 is ever.
double seen_within_of(const JsonField& field);

/// A size against the full-size robot: finite and above 0.
double scale_of(const JsonField& field);

}  // namespace clearway
