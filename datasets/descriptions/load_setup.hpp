#pragma once

#include <Eigen/Geometry>
#include <filesystem>
#include <map>
#include <optional>
#include <string>
#include <utility>
#include <variant>
#include <vector>

namespace clearway {

class YamlFields;

/// A box about the origin of the object's frame, metres.
struct LoadBox {
  Eigen::Vector3d edges = Eigen::Vector3d::Ones();
};
/// A cylinder along z about the origin, metres.
struct LoadCylinder {
  double radius = 1, length = 1;
};
/// A capsule along z about the origin, metres.
struct LoadCapsule {
  double radius = 1, length = 1;  ///< between the centres of the caps
};
/// A sphere about the origin, metres.
struct LoadSphere {
  double radius = 1;
};
/// The convex hull of a mesh, in the mesh's frame.
struct LoadMesh {
  std::filesystem::path file;  ///< .dae, .obj, .ply or .stl; its convex hull counts
  double scale = 1;
};
/// The convex hull of points, metres.
struct LoadHull {
  std::vector<Eigen::Vector3d> points;  ///< at least one
};
using LoadShape = std::variant<LoadBox, LoadCylinder, LoadCapsule, LoadSphere, LoadMesh, LoadHull>;

/// An object that rides on a link of the robot. See datasets/FORMATS.md for the file.
struct LoadSetup {
  std::string name;
  LoadShape shape;
  std::string link;
  Eigen::Isometry3d link_from_load = Eigen::Isometry3d::Identity();
  double mass = 0;                   ///< kg, full size
  std::vector<std::string> touches;  ///< links beside `link` that may touch it
  std::vector<int> legs;             ///< from 1; empty: all
};

/// An object that stands in the map, is taken and is put elsewhere. See datasets/FORMATS.md for the file.
struct PickSetup {
  std::string name;
  LoadShape shape;
  std::string link;  ///< that carries it
  double mass = 0;   ///< kg, full size
  std::vector<std::string> touches;
  Eigen::Isometry3d map_from_object = Eigen::Isometry3d::Identity();
  /// Of three numbers, m, it keeps the object's attitude; none: whoever asks says it.
  std::optional<Eigen::Isometry3d> map_from_place;
  Eigen::Isometry3d object_from_tip = Eigen::Isometry3d::Identity();
  Eigen::Vector3d approach{0, 0, -0.1};  ///< m, map frame
  double lift = 0.1;                     ///< m
  double contact = 0;                    ///< m; 0: chosen
  double margin = 0;                     ///< m
  double depth = 0.005;                  ///< m that the open hand may reach into it
  /// By joint: open and closed, rad or m of the robot at its scale.
  std::map<std::string, std::pair<double, double>> grip;
};

/// One of box, cylinder, capsule, sphere, mesh and hull. @param folder that a mesh's file is relative to
/// @throws std::invalid_argument
LoadShape read_load_shape(const YamlFields& fields, const std::filesystem::path& folder);

/// @param folder that a mesh's file is relative to @throws std::invalid_argument
LoadSetup read_load(const YamlFields& fields, const std::filesystem::path& folder);

/// A load's file. @throws std::invalid_argument in one sentence naming file, line, key and what was expected.
LoadSetup load_load(const std::filesystem::path& file);

/// @param folder that a mesh's file is relative to @throws std::invalid_argument
PickSetup read_pick(const YamlFields& fields, const std::filesystem::path& folder);

/// A pick's file. @throws as load_load
PickSetup load_pick(const std::filesystem::path& file);

}  // namespace clearway
