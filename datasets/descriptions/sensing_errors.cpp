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
  explicit Draws(std::uint64_t seed) : numbers_(seed, 6'000'000'000) {}
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

}  // namespace

DrawnErrors draw_errors(const std::string& family, std::uint64_t seed) {
  Draws draws(seed);
  const std::string drawn = family == "any" ? families[draws.one_of(families.size())] : family;
  bool known = false;
  for (const char* name : families) known |= drawn == name;
  if (!known) {
    throw std::invalid_argument("noise family " + quote(family) +
                                ": expected kinect, time_of_flight, lidar, stereo or any");
  }
  DrawnErrors result{drawn, draw_noise(drawn, draws), {}};
  result.errors = draw_sequence_errors(draws);
  return result;
}

}  // namespace clearway
