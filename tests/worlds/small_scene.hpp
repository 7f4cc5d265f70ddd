#pragma once

#include <string>

namespace clearway {

/// A small world for tests: four tags on a table, a probe with three tags, three shapes, half a second.
inline const std::string small_setup = R"(
camera: {width: 320, height: 240, fx: 330, fy: 331, cx: 158, cy: 121, distortion: [-0.12, 0.05, 0.0005, -0.0004, 0]}
boards:
  - name: base
    map_from_board: [0, 0, 0.001, 0, 0, 0.1]
    tags:
      - {id: 0, size: 0.05, pose: [0.06, 0.09, 0, 0, 0, -1.5]}
      - {id: 1, size: 0.05, pose: [0.06, -0.09, 0, 0, 0, -1.5]}
  - name: probe
    tags:
      - {id: 10, size: 0.04, pose_deg: [0, 0, 0.025, 0, 0, -90]}
      - {id: 11, size: 0.04, pose_deg: [-0.025, 0, 0, 90, 0, -90]}
      - {id: 12, size: 0.04, pose_deg: [0, -0.025, 0, 90, 0, 0]}
probe: {board: probe, ball_center: [0, 0, -0.08], ball_radius: 0.02}
)";

inline const std::string small_scene = R"(
setup: setup.yaml
seed: 5
shapes:
  - {name: table, box: [1, 1, 0.02], pose: [0, 0, -0.01, 0, 0, 0], grey: 170}
  - {name: can, cylinder: [0.02, 0.06], pose: [0.1, 0, 0.03, 0, 0, 0], grey: 60}
  - {name: ball, sphere: 0.03, pose: [-0.02, 0, 0.03, 0, 0, 0], grey: 90}
camera:
  look_at: {eye: [-0.3, 0.02, 0.36], target: [0.05, 0, 0.05]}
  rate_hz: 10
  noise_sigma: 1
  blur_px: 0.5
stroke:
  duration: 0.5
  orientation_deg: [0, -15, 18]
  wobble_deg: 3
  waypoints: [{ball: [0.05, -0.03, 0.06]}, {ball: [0.08, 0, 0.09]}, {ball: [0.05, 0.03, 0.06]}]
depth:
  intrinsics: {width: 64, height: 48, fx: 60, fy: 60, cx: 31.5, cy: 23.5}
  poses:
    - look_at: {eye: [-0.3, 0.1, 0.4], target: [0, 0, 0]}
    - look_at: {eye: [0.3, 0.1, 0.4], target: [0, 0, 0]}
  noise_constant: 0.0005
  noise_quadratic: 0.002
  dropout: 0.02
  unit: 0.0001
)";

/// The same with a hand that holds the probe, and with errors stated.
inline const std::string person_setup = [] {
  std::string text = small_setup;
  text.replace(text.rfind("}\n"), 2, ", hand: [{from: [0, 0, 0.04], to: [0.03, 0, 0.1], radius: 0.025}]}\n");
  return text + R"(errors:
  camera: {focal: 0.003, aspect: 0.0005, center_px: 2, distortion_px: 0.5}
  boards: {scale: 0.002, size: 0.003, place: 0.0004, turn: 0.004}
)";
}();

/// A person who walks round with the camera, trembles and lays a finger on a tag, for a second.
inline const std::string person_scene = R"(
setup: setup.yaml
seed: 5
shapes:
  - {name: table, box: [1, 1, 0.02], pose: [0, 0, -0.01, 0, 0, 0], grey: 170}
  - {name: can, cylinder: [0.02, 0.06], pose: [0.1, 0, 0.03, 0, 0, 0], grey: 60}
camera:
  path:
    - {time: 0, look_at: {eye: [-0.3, 0.02, 0.36], target: [0.05, 0, 0.05]}}
    - {time: 0.5, look_at: {eye: [-0.28, -0.1, 0.37], target: [0.05, 0, 0.05]}}
    - {time: 1, look_at: {eye: [-0.22, -0.2, 0.38], target: [0.05, 0, 0.05]}}
  sway: {shift: 0.001, turn_deg: 0.1}
  rate_hz: 10
  noise_sigma: 1
  blur_px: 0.5
  family: worn
  errors: {dropped: 0.1, repeated: 0.2}
stroke:
  person: usual
  tremor: {shift: 0.0003}
  orientation_deg: [0, -15, 18]
  waypoints:
    - {time: 0, ball: [0.05, -0.03, 0.06]}
    - {time: 0.4, ball: [0.08, 0, 0.09]}
    - {time: 0.6, ball: [0.08, 0, 0.09]}
    - {time: 1, ball: [0.05, 0.03, 0.06]}
hands:
  covers: [{from: 0.35, to: 0.75, tag: 11}]
depth:
  intrinsics: {width: 64, height: 48, fx: 60, fy: 60, cx: 31.5, cy: 23.5}
  poses: [{look_at: {eye: [-0.2, 0.3, 0.4], target: [0.05, 0, 0.1]}}]
  unit: 0.0001
  interval: 0.1
  family: stereo
  errors: {clock_offset: 0.015, dropped: 0, repeated: 0}
  beside_pictures: true
)";

}  // namespace clearway
