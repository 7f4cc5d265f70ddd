#include "datasets/descriptions/sensing_errors.hpp"

#include <array>
#include <stdexcept>

#include "datasets/descriptions/random_numbers.hpp"
#include "mapping/system/plain_text.hpp"

namespace clearway {
namespace {

constexpr std::array<const char*, 4> families{"kinect", "time_of_flight", "lidar", "stereo"};

/// Numbers of one sequence, each asked for once, in the order of the source.
class Draws {
 public:
  explicit Draws(std::uint64_t seed, std::uint64_t stream = 6'000'000'000) : numbers_(seed, stream) {}
  double between(double low, double high) { return low + (high - low) * numbers_.uniform(next_++); }
  double either_side(double most) { return between(-most, most); }
  std::size_t one_of(std::size_t count) {
    return static_cast<std::size_t>(between(0.0, static_cast<double>(count)));
  }

 private:
  RandomNumbers numbers_;
  std::uint64_t next_ = 0;
};

DepthNoise draw_noise(const std::string& family, Draws& draws) {
  DepthNoise noise;
  noise.dropout = draws.between(0.0, 0.02);
  noise.flying = draws.between(0.2, 1.0);
  noise.lateral_px = draws.between(0.3, 1.0);
  noise.grazing_cosine = draws.between(0.05, 0.2);
  if (family == "kinect") {
    noise.range_scale = draws.between(0.5, 2.0);
    noise.disparity_step = 0.125;
  } else if (family == "time_of_flight") {
    noise.constant = draws.between(0.002, 0.006);
    noise.proportional = draws.between(0.0005, 0.003);
    noise.multipath = draws.between(0.0, 0.02);
  } else if (family == "lidar") {
    noise.constant = draws.between(0.003, 0.015);
    noise.lateral_px = 0.3;
  } else {
    noise.constant = 0.001;
    noise.quadratic = draws.between(0.001, 0.004);
    noise.baseline = draws.between(0.05, 0.12);
    noise.disparity_step = draws.between(0.03, 0.25);
  }
  return noise;
}

SequenceErrors draw_sequence_errors(Draws& draws) {
  SequenceErrors errors;
  errors.depth_scale = draws.either_side(0.01);
  errors.depth_quadratic = draws.either_side(0.002);
  errors.pose_shift = draws.between(0.001, 0.008);
  errors.pose_turn = draws.between(0.0005, 0.005);
  errors.drift_shift = draws.between(0.0, 0.003);
  errors.drift_turn = draws.between(0.0, 0.001);
  errors.mount_shift = draws.between(0.0, 0.005);
  errors.mount_turn = draws.between(0.0, 0.004);
  errors.clock_offset = draws.either_side(0.02);
  errors.focal_error = draws.either_side(0.005);
  errors.centre_error = draws.either_side(2.0);
  errors.dropped = draws.between(0.0, 0.1);
  errors.repeated = draws.between(0.0, 0.05);
  return errors;
}

/// `name`, or one of `names` for `any`. @throws std::invalid_argument for another name, naming them.
template <std::size_t count>
std::string drawn_name(const std::string& what, const std::string& name,
                       const std::array<const char*, count>& names, Draws& draws) {
  const std::string drawn = name == "any" ? names[draws.one_of(count)] : name;
  std::string list;
  for (const char* known : names) {
    if (drawn == known) return drawn;
    list += std::string(known) + ", ";
  }
  throw std::invalid_argument(what + " " + quote(name) + ": expected " + list + "or any");
}

}  // namespace

DrawnErrors draw_errors(const std::string& family, std::uint64_t seed) {
  Draws draws(seed);
  const std::string drawn = drawn_name("noise family", family, families, draws);
  DrawnErrors result{drawn, draw_noise(drawn, draws), {}};
  result.errors = draw_sequence_errors(draws);
  return result;
}

DrawnPictures draw_picture_errors(const std::string& family, std::uint64_t seed) {
  constexpr std::array<const char*, 3> cameras{"webcam", "industrial", "worn"};
  Draws draws(seed, 6'100'000'000);
  DrawnPictures result{drawn_name("camera family", family, cameras, draws), {}};
  const bool is_industrial = result.family == "industrial", is_worn = result.family == "worn";
  const double rough = is_industrial ? 0.25 : 1.0;
  PictureErrors& errors = result.errors;
  errors.brightness = rough * draws.between(0.1, is_worn ? 0.8 : 0.5);
  errors.noise = rough * draws.between(0.0, 1.0);
  errors.dropped = rough * draws.between(0.0, is_worn ? 0.1 : 0.05);
  errors.repeated = rough * draws.between(0.0, 0.05);
  errors.focal_error = rough * draws.either_side(0.004);
  errors.centre_error = rough * draws.either_side(2.0);
  errors.distortion_error = rough * draws.either_side(0.5);
  errors.board_scale = draws.either_side(0.002);
  errors.tag_size = draws.between(0.0, 0.003);
  errors.tag_place = draws.between(0.0, 0.0004);
  errors.tag_turn = draws.between(0.0, 0.004);
  return result;
}

DrawnPerson draw_person(const std::string& person, std::uint64_t seed) {
  constexpr std::array<const char*, 3> persons{"calm", "usual", "shaky"};
  Draws draws(seed, 6'200'000'000);
  DrawnPerson result;
  result.person = drawn_name("person", person, persons, draws);
  const double factor = result.person == "calm" ? 0.3 : result.person == "usual" ? 1.0 : 3.5;
  result.tremor.shift = factor * draws.between(2e-5, 6e-5);
  result.tremor.turn = factor * draws.between(2e-4, 8e-4);
  result.tremor.low_hz = draws.between(5.0, 7.0);
  result.tremor.high_hz = draws.between(9.0, 12.0);
  result.wobble = factor * draws.between(0.01, 0.04);
  result.wobble_hz = draws.between(0.3, 1.5);
  return result;
}

}  // namespace clearway
