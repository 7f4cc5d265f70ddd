#include "datasets/simulation/truth.hpp"

#include <nlohmann/json.hpp>

#include "datasets/sources/lens.hpp"

namespace clearway {
namespace {

using Json = nlohmann::ordered_json;

Json to_json(const Eigen::Vector3d& v) { return {v.x(), v.y(), v.z()}; }

/// [x, y, z, qw, qx, qy, qz]
Json to_json(const Eigen::Isometry3d& pose) {
  Eigen::Quaterniond q(pose.linear());
  if (q.w() < 0) q.coeffs() *= -1;
  const auto& t = pose.translation();
  return {t.x(), t.y(), t.z(), q.w(), q.x(), q.y(), q.z()};
}

Json to_json(const CameraIntrinsics& camera) {
  Json json{{"width", camera.width}, {"height", camera.height}, {"fx", camera.fx},
            {"fy", camera.fy},       {"cx", camera.cx},         {"cy", camera.cy}};
  if (camera.lens != LensModel::plumb_bob) json["lens"] = lens_name(camera.lens);
  const auto coefficients = coefficients_of(camera);
  json["distortion"] = std::vector<double>(coefficients.begin(), coefficients.end());
  return json;
}

Json to_json(const SceneShape& shape) {
  Json json{{"name", shape.name}};
  if (const auto* box = std::get_if<BoxShape>(&shape.geometry)) json["box"] = to_json(box->size);
  if (const auto* cylinder = std::get_if<CylinderShape>(&shape.geometry))
    json["cylinder"] = {cylinder->radius, cylinder->length};
  if (const auto* ball = std::get_if<SphereShape>(&shape.geometry)) json["sphere"] = ball->radius;
  json["map_from_shape"] = to_json(shape.map_from_shape);
  json["grey"] = shape.grey;
  return json;
}

Json to_json(const Shake& shake) {
  return {{"shift", shake.shift}, {"turn", shake.turn}, {"low_hz", shake.low_hz}, {"high_hz", shake.high_hz}};
}

Json to_json(const PictureErrors& errors) {
  return {{"brightness", errors.brightness},
          {"noise", errors.noise},
          {"dropped", errors.dropped},
          {"repeated", errors.repeated},
          {"focal_error", errors.focal_error},
          {"centre_error", errors.centre_error},
          {"distortion_error", errors.distortion_error},
          {"board_scale", errors.board_scale},
          {"tag_size", errors.tag_size},
          {"tag_place", errors.tag_place},
          {"tag_turn", errors.tag_turn}};
}

Json to_json(const SequenceErrors& errors) {
  return {{"depth_scale", errors.depth_scale},   {"depth_quadratic", errors.depth_quadratic},
          {"pose_shift", errors.pose_shift},     {"pose_turn", errors.pose_turn},
          {"drift_shift", errors.drift_shift},   {"drift_turn", errors.drift_turn},
          {"mount_shift", errors.mount_shift},   {"mount_turn", errors.mount_turn},
          {"clock_offset", errors.clock_offset}, {"focal_error", errors.focal_error},
          {"centre_error", errors.centre_error}, {"dropped", errors.dropped},
          {"repeated", errors.repeated}};
}

Json to_json(const DepthNoise& noise) {
  return {{"range_scale", noise.range_scale},
          {"constant", noise.constant},
          {"proportional", noise.proportional},
          {"quadratic", noise.quadratic},
          {"lateral_px", noise.lateral_px},
          {"flying", noise.flying},
          {"disparity_step", noise.disparity_step},
          {"baseline", noise.baseline},
          {"multipath", noise.multipath},
          {"grazing_cosine", noise.grazing_cosine},
          {"dropout", noise.dropout}};
}

/// What was drawn for this sequence, hidden from the program.
Json drawn_json(const Scene& scene) {
  Json json = Json::object();
  if (scene.stroke && !scene.stroke->person.empty())
    json["person"] = {{"name", scene.stroke->person},
                      {"tremor", to_json(scene.stroke->tremor)},
                      {"wobble", scene.stroke->wobble},
                      {"wobble_hz", scene.stroke->wobble_hz}};
  if (scene.camera && !scene.camera->family.empty())
    json["camera"] = {{"family", scene.camera->family}, {"errors", to_json(scene.camera->errors)}};
  if (scene.depth && !scene.depth->family.empty())
    json["depth"] = {{"family", scene.depth->family},
                     {"noise", to_json(*scene.depth->noise)},
                     {"errors", to_json(scene.depth->errors)}};
  if (scene.hands && scene.hands->cover_share > 0.0)
    for (const SceneHands::Cover& cover : scene.hands->covers)
      json["covers"].push_back({{"from", cover.from}, {"to", cover.to}, {"tag", cover.tag}});
  return json;
}

/// The tags of the boards where they are otherwise than stated.
Json to_json(const std::vector<BoardSetup>& boards) {
  Json json = Json::array();
  for (const BoardSetup& board : boards)
    for (const TagSetup& tag : board.tags)
      json.push_back({{"id", tag.id},
                      {"board", board.name},
                      {"size", tag.size},
                      {"board_from_tag", to_json(tag.board_from_tag)}});
  return json;
}

/// One tag as a camera sees it.
struct SeenTag {
  const CameraIntrinsics& camera;
  const Lens& lens;
  const Eigen::Isometry3d& map_from_camera;
  Eigen::Isometry3d map_from_tag;
  double size;

  Eigen::Vector3d in_map(double x, double y) const { return map_from_tag * Eigen::Vector3d(x, y, 0); }
  bool in_image(const Eigen::Vector3d& point) const {
    const Eigen::Vector3d seen = map_from_camera.inverse() * point;
    if (!(seen.z() > 1e-6)) return false;
    const auto pixel = lens.project(seen);
    return pixel && pixel->x() >= 0 && pixel->y() >= 0 && pixel->x() <= camera.width - 1 &&
           pixel->y() <= camera.height - 1;
  }

  /// Faces the camera, and a 10 x 10 grid over the tag and its quiet zone is in the image with nothing
  /// before.
  bool fully_visible(std::span<const Surface* const> surfaces) const {
    const Eigen::Vector3d eye = map_from_camera.translation();
    if ((map_from_tag.inverse() * eye).z() <= 0) return false;
    const double half = size * 5 / 8;
    for (int i = 0; i < 10; ++i) {
      for (int j = 0; j < 10; ++j) {
        const Eigen::Vector3d point = in_map(half * (i / 4.5 - 1) * 0.999, half * (j / 4.5 - 1) * 0.999);
        if (!in_image(point)) return false;
        if (cast_ray(surfaces, eye, point - eye).hit.along < 1 - 1e-6) return false;
      }
    }
    return true;
  }

  /// Pixels of the corners of the black border: top left, top right, bottom right, bottom left of the tag as
  /// one reads it. Null when a corner is behind the camera or beyond its lens.
  Json corners() const {
    const double h = size / 2;
    Json json = Json::array();
    for (const Eigen::Vector2d& corner :
         {Eigen::Vector2d(-h, h), Eigen::Vector2d(h, h), Eigen::Vector2d(h, -h), Eigen::Vector2d(-h, -h)}) {
      const Eigen::Vector3d seen = map_from_camera.inverse() * in_map(corner.x(), corner.y());
      if (!(seen.z() > 1e-6)) return nullptr;
      const auto pixel = lens.project(seen);
      if (!pixel) return nullptr;
      json.push_back({pixel->x(), pixel->y()});
    }
    return json;
  }
};

}  // namespace

struct Truth::State {
  const Scene& scene;
  Json json;
};

Truth::Truth(const Scene& scene) : state_(new State{scene, {}}) {
  Json& json = state_->json;
  json["format"] = "clearway truth 1";
  json["scene"] = std::filesystem::path(scene.name).filename().string();
  json["seed"] = scene.seed;
  if (scene.camera) json["camera"] = to_json(*scene.setup.camera);
  json["shapes"] = Json::array();
  for (const auto& shape : scene.shapes) json["shapes"].push_back(to_json(shape));
  if (Json drawn = drawn_json(scene); !drawn.empty()) json["drawn"] = std::move(drawn);
  if (scene.camera && scene.camera->errors.has_wrong_setup()) json["tags"] = to_json(scene.setup.boards);
  json["depth"] = Json::array();
  json["frames"] = Json::array();
}

Truth::~Truth() = default;

namespace {

/// Where a board is; empty when it is out of sight, or moves in no way that is known.
std::optional<Eigen::Isometry3d> map_from(const BoardSetup& board, const Setup& setup,
                                          const MovingThings& moving) {
  if (board.name == setup.probe->board)
    return moving.probe ? std::optional(moving.probe->map_from_probe) : std::nullopt;
  if (setup.gripper && board.name == setup.gripper->board) {
    if (!moving.map_from_tip) return std::nullopt;
    return *moving.map_from_tip * setup.gripper->board_from_tip.inverse();
  }
  return board.map_from_board;
}

}  // namespace

void Truth::add_image(double time, const Eigen::Isometry3d& map_from_camera, const MovingThings& moving,
                      std::span<const Surface> still, std::span<const Surface> surfaces_of_moving) {
  const Scene& scene = state_->scene;
  std::vector<const Surface*> surfaces;
  for (const auto& surface : still) surfaces.push_back(&surface);
  for (const auto& surface : surfaces_of_moving) surfaces.push_back(&surface);
  const Lens lens(*scene.setup.camera);
  Json tags = Json::array();
  for (const auto& board : scene.setup.boards) {
    const auto map_from_board = map_from(board, scene.setup, moving);
    if (!map_from_board) continue;
    for (const auto& tag : board.tags) {
      const SeenTag seen{*scene.setup.camera, lens, map_from_camera, *map_from_board * tag.board_from_tag,
                         tag.size};
      tags.push_back({{"id", tag.id},
                      {"board", board.name},
                      {"fully_visible", seen.fully_visible(surfaces)},
                      {"corners", seen.corners()}});
    }
  }
  Json frame{{"time", time}, {"map_from_camera", to_json(map_from_camera)}};
  if (moving.probe) {
    frame["map_from_probe"] = to_json(moving.probe->map_from_probe);
    frame["ball"] = to_json(moving.probe->map_ball);
  }
  if (moving.map_from_tip) frame["map_from_tip"] = to_json(*moving.map_from_tip);
  if (!moving.covered.empty()) frame["covered"] = moving.covered;
  frame["tags"] = std::move(tags);
  state_->json["frames"].push_back(std::move(frame));
}

void Truth::add_depth(double time, const Eigen::Isometry3d& map_from_sensor) {
  state_->json["depth"].push_back({{"time", time}, {"map_from_sensor", to_json(map_from_sensor)}});
}

std::string Truth::json(const RecordingSum& recording) {
  state_->json["recording"] = {{"bytes", recording.bytes}, {"crc32", recording.crc32}};
  return state_->json.dump(1) + "\n";
}

}  // namespace clearway
