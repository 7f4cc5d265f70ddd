#pragma once

#include <cstdint>
#include <string>

#include "datasets/descriptions/shake.hpp"

namespace clearway {

/// What a depth camera adds to the exact depth z of a pixel, anew for each pixel. All zero: nothing.
struct DepthNoise {
  double range_scale = 0.0;     ///< times sigma = 1.2 mm + 1.9 mm/m^2 (z - 0.4 m)^2 (Nguyen et al. 2012)
  double lateral_px = 0.0;      ///< sigma of where in the image a pixel looks; moves depth edges
  double flying = 0.0;          ///< share of such pixels at a depth edge that lie between both surfaces
  double disparity_step = 0.0;  ///< depths are steps of this many pixels of disparity, 0 = continuous
  double baseline = 0.075;      ///< between projector and camera, metres
  double grazing_cosine = 0.0;  ///< under this cosine to the normal, returns are lost: all at 0, none at it
  double dropout = 0.0;         ///< share of pixels without a return anywhere
  double constant = 0.0;        ///< further sigma = constant + proportional z + quadratic z^2, metres,
  double proportional = 0.0;    ///< no unit,
  double quadratic = 0.0;       ///< 1/m
  double multipath = 0.0;       ///< smooth patches of the image are longer, by up to this share of the depth

  /// What a real Kinect does: everything on.
  static DepthNoise structured_light() { return {1.0, 0.5, 0.3, 0.125, 0.075, 0.15, 0.01}; }
};

/// What is wrong in a sequence of depth images without anybody knowing: the same for all images, or image by
/// image. All zero: nothing.
struct SequenceErrors {
  double depth_scale = 0.0;      ///< ranges are longer by this share
  double depth_quadratic = 0.0;  ///< and by this times the range squared, 1/m
  double pose_shift = 0.0;       ///< sigma an axis of each stated position's own error, metres
  double pose_turn = 0.0;        ///< sigma an axis of each stated direction's own error, radians
  double drift_shift = 0.0;   ///< sigma an axis of the step from pose to pose of an error that stays, metres
  double drift_turn = 0.0;    ///< the same of the direction, radians
  double mount_shift = 0.0;   ///< sigma an axis of the sensor's place on what is tracked, metres
  double mount_turn = 0.0;    ///< and of its direction, radians
  double clock_offset = 0.0;  ///< s, the stated pose is the true one so much later
  double focal_error = 0.0;   ///< the stated focal length is longer by this share
  double centre_error = 0.0;  ///< the stated principal point lies so far right and down, pixels
  double dropped = 0.0;       ///< share of images that never arrive
  double repeated = 0.0;      ///< share of images that arrive a second time, with the next one's pose
};

/// The noise of a kind of sensor and the errors of a sequence, drawn from a seed.
struct DrawnErrors {
  std::string family;  ///< the one drawn for `any`
  DepthNoise noise;
  SequenceErrors errors;
};

/// What is wrong with pictures and with what the setup says of camera and boards without anybody knowing. All
/// zero: nothing.
struct PictureErrors {
  double brightness = 0.0;        ///< rms of the slow changes of brightness, in stops (factors of 2)
  double noise = 0.0;             ///< the same of the noise
  double dropped = 0.0;           ///< share of pictures that never arrive
  double repeated = 0.0;          ///< share of pictures that arrive a second time, half a picture later
  double focal_error = 0.0;       ///< the stated focal length is longer by this share
  double centre_error = 0.0;      ///< the stated principal point lies so far right and down, pixels
  double distortion_error = 0.0;  ///< the stated distortion is off by so much in the image's corner, pixels
  double board_scale = 0.0;       ///< all boards are larger than stated by this share
  double tag_size = 0.0;          ///< sigma of each tag's size, relative
  double tag_place = 0.0;         ///< sigma an axis of each tag's place on its board, metres
  double tag_turn = 0.0;          ///< sigma an axis of its direction, radians

  /// Whether camera or boards are not what the setup says.
  bool has_wrong_setup() const {
    return focal_error != 0.0 || centre_error != 0.0 || distortion_error != 0.0 || board_scale != 0.0 ||
           tag_size != 0.0 || tag_place != 0.0 || tag_turn != 0.0;
  }
};

/// Draws one sequence's errors, evenly between the family's bounds (datasets/FORMATS.md).
/// @param family webcam, industrial, worn, or any: one of these.
/// @throws std::invalid_argument for another name.
struct DrawnPictures {
  std::string family;  ///< the one drawn for `any`
  PictureErrors errors;
};
DrawnPictures draw_picture_errors(const std::string& family, std::uint64_t seed);

/// How a person's hand trembles and turns.
struct DrawnPerson {
  std::string person;  ///< the one drawn for `any`
  Shake tremor;
  double wobble = 0.0;  ///< rad, amplitude
  double wobble_hz = 0.5;
};
/// @param person calm, usual, shaky, or any: one of these.
/// @throws std::invalid_argument for another name.
DrawnPerson draw_person(const std::string& person, std::uint64_t seed);

/// Draws one sequence's errors: numbers of that family, evenly between its bounds (datasets/FORMATS.md).
/// @param family kinect, time_of_flight, lidar, stereo, or any: one of these.
/// @throws std::invalid_argument for another name.
DrawnErrors draw_errors(const std::string& family, std::uint64_t seed);

}  // namespace clearway
