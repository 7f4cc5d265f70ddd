#include "datasets/descriptions/scene_sensing.hpp"

#include <stdexcept>
#include <tuple>

#include "datasets/descriptions/setup_tracking.hpp"

namespace clearway {
namespace {

constexpr Bounds share_bounds{0, 1}, signed_bounds{-1, 1};

/// Keys and numbers of `noise:`, by the drawn ones unless given.
DepthNoise read_noise(const YamlFields& fields, DepthNoise noise) {
  const std::tuple<const char*, double*, Bounds> numbers[]{
      {"range_scale", &noise.range_scale, {0, 100}},
      {"lateral_px", &noise.lateral_px, {0, 20}},
      {"flying", &noise.flying, share_bounds},
      {"disparity_step", &noise.disparity_step, {0, 10}},
      {"baseline", &noise.baseline, {1e-3, 10}},
      {"grazing_cosine", &noise.grazing_cosine, share_bounds},
      {"dropout", &noise.dropout, share_bounds},
      {"constant", &noise.constant, share_bounds},
      {"proportional", &noise.proportional, share_bounds},
      {"quadratic", &noise.quadratic, share_bounds},
      {"multipath", &noise.multipath, share_bounds}};
  for (const auto& [key, number, bounds] : numbers) *number = fields.number(key, bounds, *number);
  fields.finish();
  return noise;
}

SequenceErrors read_errors(const YamlFields& fields, SequenceErrors errors) {
  const std::tuple<const char*, double*, Bounds> numbers[]{
      {"depth_scale", &errors.depth_scale, signed_bounds},
      {"depth_quadratic", &errors.depth_quadratic, signed_bounds},
      {"pose_shift", &errors.pose_shift, share_bounds},
      {"drift_shift", &errors.drift_shift, share_bounds},
      {"mount_shift", &errors.mount_shift, share_bounds},
      {"clock_offset", &errors.clock_offset, signed_bounds},
      {"focal_error", &errors.focal_error, {-0.5, 0.5}},
      {"centre_error", &errors.centre_error, {-100, 100}},
      {"dropped", &errors.dropped, share_bounds},
      {"repeated", &errors.repeated, share_bounds}};
  for (const auto& [key, number, bounds] : numbers) *number = fields.number(key, bounds, *number);
  errors.pose_turn = fields.angle("pose_turn", errors.pose_turn);
  errors.drift_turn = fields.angle("drift_turn", errors.drift_turn);
  errors.mount_turn = fields.angle("mount_turn", errors.mount_turn);
  fields.finish();
  return errors;
}

PictureErrors read_picture_errors(const YamlFields& fields, PictureErrors errors) {
  const std::tuple<const char*, double*, Bounds> numbers[]{
      {"brightness", &errors.brightness, {0, 8}},
      {"noise", &errors.noise, {0, 8}},
      {"dropped", &errors.dropped, share_bounds},
      {"repeated", &errors.repeated, share_bounds},
      {"focal_error", &errors.focal_error, {-0.5, 0.5}},
      {"centre_error", &errors.centre_error, {-100, 100}},
      {"distortion_error", &errors.distortion_error, {-100, 100}},
      {"board_scale", &errors.board_scale, {-0.5, 0.5}},
      {"tag_size", &errors.tag_size, {0, 0.5}},
      {"tag_place", &errors.tag_place, share_bounds}};
  for (const auto& [key, number, bounds] : numbers) *number = fields.number(key, bounds, *number);
  errors.tag_turn = fields.angle("tag_turn", errors.tag_turn);
  fields.finish();
  return errors;
}

/// A tag of the probe's board.
int read_tag(const YamlFields& fields, const Setup& setup) {
  const int id = fields.integer("tag", {0, 1e6});
  for (const TagSetup& tag : setup.board(setup.probe->board)->tags)
    if (tag.id == id) return id;
  fields.fail("tag", "expected a tag of the probe's board, got " + std::to_string(id));
}

}  // namespace

Shake read_shake(const YamlFields& fields, const std::string& key, const Shake& usual) {
  if (!fields.has(key)) return usual;
  const YamlFields given = fields.map(key);
  Shake shake = usual;
  shake.shift = given.number("shift", share_bounds, shake.shift);
  shake.turn = given.angle("turn", shake.turn);
  shake.low_hz = given.number("low_hz", {1e-3, 1e3}, shake.low_hz);
  shake.high_hz = given.number("high_hz", {1e-3, 1e3}, shake.high_hz);
  if (!(shake.high_hz > shake.low_hz)) given.fail("high_hz", "expected more than low_hz");
  given.finish();
  return shake;
}

void read_tremor(const YamlFields& fields, uint64_t seed, SceneStroke& stroke) {
  stroke.seed = seed;
  if (fields.has("person")) {
    DrawnPerson drawn;
    try {
      drawn = draw_person(fields.text("person"), seed);
    } catch (const std::invalid_argument&) {
      fields.fail("person", "expected calm, usual, shaky or any");
    }
    stroke.person = drawn.person;
    stroke.tremor = drawn.tremor;
    stroke.wobble = drawn.wobble;
    stroke.wobble_hz = drawn.wobble_hz;
  }
  stroke.tremor = read_shake(fields, "tremor", stroke.tremor);
  stroke.wobble = fields.angle("wobble", stroke.wobble);
  stroke.wobble_hz = fields.number("wobble_hz", {0, 100}, stroke.wobble_hz);
}

SceneHands read_hands(const YamlFields& fields, const Setup& setup) {
  if (!setup.probe) fields.fail("probe", "expected a setup with a probe for the hands to hold");
  SceneHands hands;
  hands.probe = fields.has("probe") ? read_capsules(fields, "probe") : setup.probe->hand;
  if (setup.gripper)
    hands.gripper = fields.has("gripper") ? read_capsules(fields, "gripper") : setup.gripper->hand;
  hands.grey = fields.number("grey", {0, 255}, hands.grey);
  hands.cover_share = fields.number("cover_share", {0, 0.9}, hands.cover_share);
  for (const YamlFields& entry : fields.list_of_maps("covers")) {
    SceneHands::Cover cover{entry.number("from", {0, 3600}), entry.number("to", {0, 3600}),
                            read_tag(entry, setup)};
    if (!(cover.to > cover.from)) entry.fail("to", "expected a time after 'from'");
    hands.covers.push_back(cover);
    entry.finish();
  }
  fields.finish();
  return hands;
}

void read_picture_sensing(const YamlFields& fields, uint64_t seed, SceneCamera& camera) {
  if (fields.has("family")) {
    DrawnPictures drawn;
    try {
      drawn = draw_picture_errors(fields.text("family"), seed);
    } catch (const std::invalid_argument&) {
      fields.fail("family", "expected webcam, industrial, worn or any");
    }
    camera.family = drawn.family;
    camera.errors = drawn.errors;
  }
  if (fields.has("errors")) camera.errors = read_picture_errors(fields.map("errors"), camera.errors);
}

void read_sensing(const YamlFields& fields, uint64_t seed, SceneDepth& depth) {
  if (fields.has("family")) {
    DrawnErrors drawn;
    try {
      drawn = draw_errors(fields.text("family"), seed);
    } catch (const std::invalid_argument&) {
      fields.fail("family", "expected kinect, time_of_flight, lidar, stereo or any");
    }
    depth.family = drawn.family;
    depth.noise = drawn.noise;
    depth.errors = drawn.errors;
  }
  if (fields.has("noise")) depth.noise = read_noise(fields.map("noise"), depth.noise.value_or(DepthNoise{}));
  if (fields.has("errors")) depth.errors = read_errors(fields.map("errors"), depth.errors);
  for (const char* key : {"noise_constant", "noise_quadratic", "dropout"})
    if (depth.noise && fields.has(key))
      fields.fail(key, "expected it under 'noise' beside a family or noise");
}

}  // namespace clearway
