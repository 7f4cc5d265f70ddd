#include "datasets/descriptions/scene_sensing.hpp"

#include <stdexcept>
#include <tuple>

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

}  // namespace

void read_sensing(const YamlFields& fields, uint64_t seed, SceneDepth& depth) {
  if (fields.has("family")) {
    DrawnErrors drawn;
    try {
      drawn = draw_errors(fields.text("family"), seed);
    } catch (const std::invalid_argument&) {
      fields.fail("family", "expected kinect, time_of_flight, lidar, stereo or any");
    }
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
