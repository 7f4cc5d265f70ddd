#include <charconv>
#include <cmath>
#include <stdexcept>

#include "apps/problem_sets/planning_scene.hpp"
#include "mapping/system/plain_text.hpp"

namespace clearway {
namespace {

constexpr std::size_t most_pieces = 100'000, most_mesh_points = 6'000'000;

/// Words and lines of the text; knows the line that it is at.
class SceneWords {
 public:
  SceneWords(const std::string& text, const std::filesystem::path& file) : text_(text), file_(file) {}

  [[noreturn]] void refuse(const std::string& expected) const {
    throw std::invalid_argument("scene " + quote_path(file_.string()) + ", line " + std::to_string(line_) +
                                ": expected " + expected + ".");
  }

  /// The rest of the line, without blanks at its ends.
  std::string line() {
    const std::size_t end = std::min(text_.find('\n', at_), text_.size());
    std::string rest = text_.substr(at_, end - at_);
    at_ = std::min(end + 1, text_.size());
    line_ += end < text_.size();
    const std::size_t first = rest.find_first_not_of(" \t\r");
    if (first == std::string::npos) return "";
    return rest.substr(first, rest.find_last_not_of(" \t\r") + 1 - first);
  }

  /// The next word, wherever it is; empty at the end.
  std::string word() {
    while (at_ < text_.size() && is_blank(text_[at_])) line_ += text_[at_++] == '\n';
    const std::size_t begin = at_;
    while (at_ < text_.size() && !is_blank(text_[at_])) ++at_;
    return text_.substr(begin, at_ - begin);
  }

  double number(const std::string& expected, double low, double high) {
    const std::string text = word();
    double value = 0.0;
    const char* first = text.data() + (text.starts_with('+') ? 1 : 0);
    const auto [stop, error] = std::from_chars(first, text.data() + text.size(), value);
    if (text.empty() || error != std::errc() || stop != text.data() + text.size() || !(value >= low) ||
        !(value <= high))
      refuse(expected + ", got " + quote(text));
    return value;
  }

  std::size_t count(const std::string& of, std::size_t most) {
    const double value = number("a number of " + of + " up to " + std::to_string(most), 0.0, 1e15);
    if (value != std::floor(value) || value > static_cast<double>(most))
      refuse("a number of " + of + " up to " + std::to_string(most));
    return static_cast<std::size_t>(value);
  }

  std::size_t place() const { return at_; }
  std::size_t line_number() const { return line_; }
  void go_to(std::size_t place, std::size_t line_number) { at_ = place, line_ = line_number; }

 private:
  static bool is_blank(char c) { return c == ' ' || c == '\t' || c == '\r' || c == '\n'; }

  const std::string& text_;
  const std::filesystem::path& file_;
  std::size_t at_ = 0, line_ = 1;
};

Eigen::Vector3d read_point(SceneWords& words) {
  Eigen::Vector3d point;
  for (double& value : point) value = words.number("a position x y z in metres", -1e3, 1e3);
  return point;
}

Eigen::Isometry3d read_pose(SceneWords& words) {
  const Eigen::Vector3d at = read_point(words);
  Eigen::Vector4d turn;
  for (double& value : turn) value = words.number("a quaternion x y z w", -1e3, 1e3);
  if (const std::string fault = unit_fault(turn, "x y z w"); !fault.empty() && !turn.isZero(0.0))
    words.refuse(fault);
  return pose_of_quaternion(at, turn);
}

std::vector<Eigen::Vector3d> read_mesh(SceneWords& words) {
  std::vector<Eigen::Vector3d> vertices(words.count("vertices", most_mesh_points)), corners;
  const std::size_t triangles = words.count("triangles", most_mesh_points / 3);
  for (Eigen::Vector3d& vertex : vertices) vertex = read_point(words);
  for (std::size_t i = 0; i < 3 * triangles; ++i) {
    const double index = words.number("the index of a vertex", 0.0, static_cast<double>(vertices.size()) - 1);
    corners.push_back(vertices[static_cast<std::size_t>(index)]);
  }
  if (corners.empty()) words.refuse("a mesh of at least one triangle");
  return corners;
}

/// The sizes behind a shape's name; of a plane its numbers.
void read_shape(SceneWords& words, ForeignSolid& solid, Eigen::Vector4d& plane) {
  const auto size = [&] { return words.number("a size in metres", 1e-9, 1e3); };
  if (solid.kind == "box") {
    const double x = size(), y = size(), z = size();
    solid.shape = Shape::box({x, y, z});
  } else if (solid.kind == "sphere") {
    solid.shape = Shape::sphere(size());
  } else if (solid.kind == "cylinder" || solid.kind == "cone") {
    const double radius = size(), length = size();
    solid.shape = solid.kind == "cone" ? cone_shape(radius, length) : Shape::cylinder(radius, length);
  } else if (solid.kind == "mesh") {
    solid.triangles = read_mesh(words);
  } else if (solid.kind == "plane") {
    for (double& value : plane) value = words.number("a plane a b c d", -1e6, 1e6);
    if (plane.head<3>().norm() < 1e-9) words.refuse("a plane a b c d with a normal a b c that is not 0");
  } else {
    words.refuse("box, sphere, cylinder, cone, mesh or plane, got " + quote(solid.kind));
  }
}

}  // namespace

ForeignWorld read_scene_text(const std::string& text, const std::filesystem::path& file,
                             const SceneContext& context) {
  SceneWords words(text, file);
  ForeignWorld world;
  world.name = file.stem().string();
  world.frames = SceneFrames(context.planning_frames);
  world.frames.place_links(context.robot, {});
  words.line();  // the scene's name
  bool has_poses = false, is_first = true;
  for (;;) {
    const std::string marker = words.word();
    if (marker == ".") return world;
    if (marker != "*") words.refuse("'*' before an object or '.' at the end, got " + quote(marker));
    const std::string object = words.line();
    if (is_first) {  // poses of objects came later: then the line has blanks
      const std::size_t place = words.place(), line = words.line_number();
      has_poses = words.line().find(' ') != std::string::npos;
      words.go_to(place, line);
      is_first = false;
    }
    const Eigen::Isometry3d map_from_object = has_poses ? read_pose(words) : Eigen::Isometry3d::Identity();
    const std::size_t pieces = words.count("shapes", most_pieces);
    for (std::size_t i = 0; i < pieces; ++i) {
      ForeignSolid solid;
      solid.object = object;
      solid.kind = words.word();
      Eigen::Vector4d plane;
      read_shape(words, solid, plane);
      solid.map_from_shape = map_from_object * read_pose(words);
      for (int k = 0; k < 4; ++k) words.number("a colour r g b a", -1e6, 1e6);
      if (solid.kind == "plane")
        solid.triangles =
            plane_triangles(plane, solid.map_from_shape.inverse().translation(), context.plane_reach);
      if (world.solids.size() >= most_pieces) words.refuse("at most 100000 shapes");
      world.solids.push_back(std::move(solid));
    }
    const std::size_t subframes = has_poses ? words.count("subframes", most_pieces) : 0;
    for (std::size_t i = 0; i < subframes; ++i) {
      words.word();
      read_pose(words);
    }
  }
}

}  // namespace clearway
