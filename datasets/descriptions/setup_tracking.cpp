#include "datasets/descriptions/setup_tracking.hpp"

#include <algorithm>
#include <set>

#include "datasets/camera_files/camera_file.hpp"
#include "datasets/sources/lens.hpp"
#include "datasets/yaml/yaml_fields.hpp"

namespace clearway {
namespace {

// m; in millimetres nearly all are beyond.
constexpr Bounds tag_sizes{0.0005, 10}, ball_radii{0.0005, 2};

constexpr Bounds share{0, 0.5};

/// `otherwise` is what holds for all boards.
BoardErrorsSetup read_board_errors(const YamlFields& fields, const BoardErrorsSetup& otherwise) {
  BoardErrorsSetup errors = otherwise;
  const auto read = [&](const char* key, Bounds bounds, std::optional<double>& value) {
    if (const auto given = fields.optional_number(key, bounds)) value = given;
  };
  read("scale", share, errors.scale);
  read("size", share, errors.size);
  read("place", not_negative, errors.place);
  if (fields.has_angles("turn")) errors.turn = fields.angle("turn", 0.0);
  fields.finish();
  return errors;
}

BoardSetup read_board(const YamlFields& fields, const BoardErrorsSetup& errors, int last_id) {
  BoardSetup board;
  board.name = fields.text("name");
  for (const auto& entry : fields.list_of_maps("tags")) {
    TagSetup tag;
    tag.id = entry.integer("id", {0, static_cast<double>(last_id)});
    tag.size = entry.number("size", tag_sizes);
    tag.board_from_tag = entry.pose("pose", tag.board_from_tag);
    entry.finish();
    board.tags.push_back(tag);
  }
  if (board.tags.empty()) fields.fail("tags", "expected at least one tag");
  board.errors = fields.has("errors") ? read_board_errors(fields.map("errors"), errors) : errors;
  if (fields.has_angles("map_from_board")) board.map_from_board = fields.pose("map_from_board");
  fields.finish();
  return board;
}

LensModel read_lens_name(const YamlFields& fields) {
  const std::string name = fields.text("lens", "plumb_bob");
  const auto lens = lens_named(name);
  if (!lens) fields.fail("lens", std::string("expected ") + known_lenses + ", got '" + name + "'");
  return *lens;
}

}  // namespace

CameraIntrinsics read_camera(const YamlFields& fields, CameraAxes axes) {
  CameraIntrinsics camera;
  camera.width = fields.integer("width", {1, 20000});
  camera.height = fields.integer("height", {1, 20000});
  camera.fx = fields.number("fx", above_zero);
  camera.fy = fields.number("fy", within_reach);
  if (camera.fy == 0.0) fields.fail("fy", "expected a number that is not 0");
  if (camera.fy < 0.0 && axes == CameraAxes::y_down)
    fields.fail("fy",
                "expected a positive number; a y axis that points up, as ICL-NUIM's, is that of depth alone: "
                "`source: {depth: {camera: …}}`");
  camera.cx = fields.number("cx", within_reach);
  camera.cy = fields.number("cy", within_reach);
  const LensModel lens = read_lens_name(fields);
  std::vector<double> coefficients;
  if (fields.has("distortion"))
    coefficients = fields.numbers("distortion", within_reach, coefficient_count(lens));
  set_lens(camera, lens, coefficients);
  if (camera.fy < 0.0 && has_distortion(camera))
    fields.fail("fy", "expected a positive number beside a distortion");
  fields.finish();
  return camera;
}

CameraIntrinsics read_camera_of_setup(const YamlFields& fields, const std::filesystem::path& folder,
                                      bool is_rectified, std::vector<std::string>& notes, CameraAxes axes) {
  if (!fields.has("file")) return read_camera(fields, axes);
  if (fields.has("rectified")) is_rectified = fields.boolean("rectified");
  std::optional<ImageSize> size;
  if (fields.has("width") || fields.has("height"))
    size = {fields.integer("width", {1, 20000}), fields.integer("height", {1, 20000})};
  std::optional<LensModel> lens;
  if (fields.has("lens")) lens = read_lens_name(fields);
  std::string note;
  const CameraIntrinsics camera =
      load_camera_file(folder / fields.file("file"), fields.has("name") ? fields.text("name") : "",
                       is_rectified, size, lens, &note);
  if (!note.empty() && std::find(notes.begin(), notes.end(), note + ".") == notes.end())
    notes.push_back(note + ".");
  fields.finish();
  return camera;
}

std::vector<CapsuleSetup> read_capsules(const YamlFields& fields, const std::string& key) {
  std::vector<CapsuleSetup> capsules;
  for (const auto& entry : fields.list_of_maps(key)) {
    capsules.push_back({entry.vector("from"), entry.vector("to"), entry.number("radius", above_zero)});
    entry.finish();
  }
  return capsules;
}

ErrorsSetup read_errors(const YamlFields& fields) {
  ErrorsSetup errors;
  if (fields.has("camera")) {
    const YamlFields camera = fields.map("camera");
    errors.camera.focal = camera.optional_number("focal", share);
    errors.camera.aspect = camera.optional_number("aspect", share);
    errors.camera.center = camera.optional_number("center_px", not_negative);
    errors.camera.distortion = camera.optional_number("distortion_px", not_negative);
    camera.finish();
  }
  if (fields.has("boards")) errors.boards = read_board_errors(fields.map("boards"), {});
  errors.edge = fields.optional_number("edge_px", not_negative);
  fields.finish();
  return errors;
}

std::vector<BoardSetup> read_boards(const YamlFields& fields, const BoardErrorsSetup& errors, int last_id) {
  std::vector<BoardSetup> boards;
  std::set<std::string> names;
  std::set<int> ids;
  for (const auto& entry : fields.list_of_maps("boards")) {
    boards.push_back(read_board(entry, errors, last_id));
    if (!names.insert(boards.back().name).second) entry.fail("name", "this board is given twice");
    for (const auto& tag : boards.back().tags)
      if (!ids.insert(tag.id).second)
        entry.fail("tags", "tag " + std::to_string(tag.id) + " is used twice; expected each id once");
  }
  return boards;
}

ProbeSetup read_probe(const YamlFields& fields, const Setup& setup) {
  ProbeSetup probe;
  probe.board = fields.text("board");
  if (!setup.board(probe.board))
    fields.fail("board", "expected the name of one of the boards, got '" + probe.board + "'");
  probe.ball_center = fields.vector("ball_center");
  probe.ball_radius = fields.number("ball_radius", ball_radii);
  probe.robot_error = fields.number("robot_error", not_negative, 0);
  probe.tracking_error = fields.number("tracking_error", not_negative, 0);
  probe.modelling_error = fields.number("modelling_error", not_negative, 0);
  const std::string tracking = fields.text("tracking", "bound");
  if (tracking != "bound" && tracking != "constant")
    fields.fail("tracking", "expected bound (each sample pays how far it may be off) or constant");
  probe.constant_tracking = tracking == "constant";
  probe.hand = read_capsules(fields, "hand");
  const double tracking_error = probe.constant_tracking ? probe.tracking_error : 0.0;
  if (probe.ball_radius - probe.robot_error - tracking_error - probe.modelling_error <= 0)
    fields.fail("ball_radius",
                probe.constant_tracking
                    ? "expected more than the sum of robot_error, tracking_error and modelling_error"
                    : "expected more than the sum of robot_error and modelling_error");
  fields.finish();
  return probe;
}

GripperSetup read_gripper(const YamlFields& fields, const Setup& setup) {
  GripperSetup gripper;
  gripper.board = fields.text("board");
  const BoardSetup* board = setup.board(gripper.board);
  if (board == nullptr)
    fields.fail("board", "expected the name of one of the boards, got '" + gripper.board + "'");
  if (board->map_from_board) fields.fail("board", "expected a board that moves");
  if (setup.probe && setup.probe->board == gripper.board)
    fields.fail("board", "expected another board than the probe's");
  gripper.board_from_tip = fields.pose("tip", gripper.board_from_tip);
  gripper.hand = read_capsules(fields, "hand");
  fields.finish();
  return gripper;
}

HandsSetup read_hands_setup(const YamlFields& fields) {
  HandsSetup hands;
  hands.margin = fields.optional_number("margin", {0, 0.5});
  hands.latency = fields.number("latency", {0, 0.2}, hands.latency);
  hands.acceleration = fields.number("acceleration", {0, 100}, hands.acceleration);
  hands.hidden = fields.number("hidden", {0, 10}, hands.hidden);
  fields.finish();
  return hands;
}

AcceptanceSetup read_acceptance(const YamlFields& fields) {
  AcceptanceSetup acceptance;
  acceptance.max_reprojection_px = fields.optional_number("max_reprojection_px", above_zero);
  acceptance.min_ambiguity = fields.optional_number("min_ambiguity", not_negative);
  if (fields.has("min_tags")) acceptance.min_tags = fields.integer("min_tags", {1, 100});
  acceptance.max_noise = fields.optional_number("max_noise", {1, 1e6});
  acceptance.max_speed = fields.optional_number("max_speed", above_zero);
  acceptance.max_turn_speed = fields.optional_number("max_turn_speed", above_zero);
  acceptance.max_pause = fields.optional_number("max_pause", above_zero);
  acceptance.pixel_noise = fields.optional_number("pixel_noise", above_zero);
  if (fields.has("fixed_camera")) acceptance.fixed_camera = fields.boolean("fixed_camera");
  fields.finish();
  return acceptance;
}

DetectorSetup read_detector(const YamlFields& fields) {
  DetectorSetup detector;
  const auto whole = [&](const char* key, Bounds bounds, std::optional<int>& value) {
    if (fields.has(key)) value = fields.integer(key, bounds);
  };
  whole("decimate", {1, 2}, detector.decimate);
  whole("threads", {1, 64}, detector.threads);
  whole("max_hamming", {0, 2}, detector.max_hamming);
  detector.sigma = fields.optional_number("sigma", {0, 5});
  detector.sharpening = fields.optional_number("sharpening", {0, 10});
  detector.min_margin = fields.optional_number("min_margin", {0, 255});
  const std::vector<std::string> families = fields.texts("families");
  if (fields.has("families")) {
    std::string names;
    for (const auto& [name, ids] : tag_family_ids()) names += (names.empty() ? "" : ", ") + name;
    if (families.size() != 1 || !tag_family_ids().contains(families[0]))
      fields.fail("families", "expected one of " + names + " in brackets");
    detector.family = families[0];
  }
  fields.finish();
  return detector;
}

const std::map<std::string, int>& tag_family_ids() {
  static const std::map<std::string, int> ids{{"tag16h5", 30},       {"tag25h9", 35},
                                              {"tag36h10", 2320},    {"tag36h11", 587},
                                              {"tagCircle21h7", 38}, {"tagStandard41h12", 2115}};
  return ids;
}

}  // namespace clearway
